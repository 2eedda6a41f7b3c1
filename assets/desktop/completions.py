"""Completions for bash, zsh and fish of a command line that command_line.py has read."""
import re

NOTE = "# Completions of dapple, made from the program's own --help by completions.py.\n"


def caseless(extension):
    """A shell pattern: ply gives [pP][lL][yY]."""
    return "".join(f"[{c}{c.upper()}]" if c.isalpha() else c for c in extension)


def summary(text):
    """The help without lists of choices, defaults and remarks: for one line of a menu."""
    text = re.sub(r"^\S+\|\S+[:;,] |: \S+\|\S+.*| \[.*| \(.*", "", text)
    return text.split("; ")[0].rstrip(".")


# ---- bash

BASH = """# shellcheck shell=bash
# Files with these extensions, and folders.
_dapple_files() {
  compopt -o filenames 2>/dev/null
  if declare -F _filedir >/dev/null; then  # of the package bash-completion: knows quotes and tildes
    _filedir "${1:+@($1)}"
    return
  fi
  local word
  while IFS= read -r word; do
    [[ -d $word || -z $1 || ${word,,} =~ \\.($1)$ ]] && COMPREPLY+=("$word")
  done < <(compgen -f -- "$cur")
}

_dapple() {
  local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD - 1]} word command=''
  COMPREPLY=()
  # bash takes --option=value for three words.
  if [[ $cur == = ]]; then
    cur=
  elif [[ $prev == = ]]; then
    prev=${COMP_WORDS[COMP_CWORD - 2]}
  fi
  for word in "${COMP_WORDS[@]:1:COMP_CWORD-1}"; do
    if [[ $word != -* ]]; then
      command=$word
      break
    fi
  done
  case "$command $prev" in
@VALUES@
  esac
  case "$command" in
@COMMANDS@
  esac
}

complete -F _dapple dapple
"""


def bash_words(words):
    return f"mapfile -t COMPREPLY < <(compgen -W '{' '.join(words)}' -- \"$cur\")"


def bash_value(option):
    """What completes the option's value: words, files, or nothing."""
    if option.choices:
        return bash_words(option.choices)
    return f"_dapple_files '{'|'.join(option.extensions)}'" if option.extensions else ":"


def bash_command(command):
    names = [name for option in command.named for name in option.names + option.off]
    files = [bash_value(option) for option in command.positionals]
    return [
        f"    {command.name})",
        "      if [[ $cur == -* ]]; then",
        "        " + bash_words(names),
        *(["      else", "        " + files[0]] if files else []),
        "      fi",
        "      ;;",
    ]


def bash(whole, commands):
    values = []
    for command in commands:
        for option in command.named:
            if option.value:
                cases = " | ".join(f'"{command.name} {name}"' for name in option.names)
                values += [f"    {cases})", "      " + bash_value(option), "      return"]
                values.append("      ;;")
    starts = [command.name for command in commands]
    starts += [name for option in whole.named for name in option.names]
    blocks = ["    '')", "      " + bash_words(starts), "      ;;"]
    for command in commands:
        blocks += bash_command(command)
    text = BASH.replace("@VALUES@", "\n".join(values))
    return NOTE + text.replace("@COMMANDS@", "\n".join(blocks))


# ---- zsh

ZSH = """#compdef dapple
@NOTE@
_dapple() {
  local curcontext=$curcontext state line
  typeset -A opt_args
  local -a commands=(
@COMMANDS@
  )
  _arguments -C \\
@OPTIONS@
    '1:command:->command' \\
    '*::argument:->argument'
  case $state in
    command)
      _describe -t commands command commands
      ;;
    argument)
      curcontext=${curcontext%:*:*}:dapple-$line[1]:
      case $line[1] in
@ARGUMENTS@
      esac
      ;;
  esac
}

_dapple "$@"
"""


def zsh_text(text):
    return re.sub(r"([][:\\])", r"\\\1", text).replace("'", "'\\''")


def zsh_value(option):
    if option.choices:
        return f"({' '.join(option.choices)})"
    if option.extensions:
        return f'_files -g "*.(#i)({"|".join(option.extensions)})(-.)"'
    return " "


def zsh_specs(option):
    text = zsh_text(summary(option.help))
    if option.positional:
        return [f"'*:{option.names[0]}:{zsh_value(option)}'"]
    names = option.names + option.off
    others = f"({' '.join(names)})" if len(names) > 1 else ""
    value = f":{option.names[-1].lstrip('-')}:{zsh_value(option)}" if option.value else ""
    equals = {name: "=" if option.value and name.startswith("--") else "" for name in names}
    return [f"'{others}{name}{equals[name]}[{text}]{value}'" for name in names]


def zsh(whole, commands):
    described = [f"    '{c.name}:{zsh_text(summary(c.help))}'" for c in commands]
    options = [f"    {spec} \\" for option in whole.named for spec in zsh_specs(option)]
    blocks = []
    for command in commands:
        specs = [spec for option in command.options for spec in zsh_specs(option)]
        lines = " \\\n".join(f"            {spec}" for spec in specs)
        blocks += [f"        {command.name})", "          _arguments \\", lines, "          ;;"]
    text = ZSH.replace("@NOTE@", NOTE.rstrip()).replace("@COMMANDS@", "\n".join(described))
    return text.replace("@OPTIONS@", "\n".join(options)).replace("@ARGUMENTS@", "\n".join(blocks))


# ---- fish

FISH = """
# Files with one of these extensions, and folders.
function __dapple_files
    set -l word (commandline -ct | string replace -r -- '^--[^=]*=' '')
    for path in (complete -C "__dapple_no_such_command $word")
        if string match -qr '/$' -- $path; or string match -qri -- "\\\\.($argv[1])\\$" $path
            echo $path
        end
    end
end

complete -c dapple -f
"""


def fish_quoted(text):
    return "'" + text.replace("\\", "\\\\").replace("'", "\\'") + "'"


def fish_value(option):
    if option.choices:
        return " -x -a " + fish_quoted(" ".join(option.choices))
    if option.extensions:
        return " -x -a " + fish_quoted(f"(__dapple_files '{'|'.join(option.extensions)}')")
    return " -x" if option.value else ""


def fish_option(option, condition):
    text = fish_quoted(summary(option.help))
    start = f"complete -c dapple -n {fish_quoted(condition)}"
    if option.positional:
        return [start + fish_value(option).replace(" -x", "", 1)] if option.extensions else []
    flags = [f" -{'l' if n.startswith('--') else 's'} {n.lstrip('-')}" for n in option.names]
    lines = [start + "".join(flags) + fish_value(option) + f" -d {text}"]
    return lines + [start + f" -l {name.lstrip('-')} -d {text}" for name in option.off]


def fish(whole, commands):
    lines = []
    for option in whole.named:
        lines += fish_option(option, "__fish_use_subcommand")
    for command in commands:
        text = fish_quoted(summary(command.help))
        lines.append(f"complete -c dapple -n __fish_use_subcommand -a {command.name} -d {text}")
    for command in commands:
        condition = f"__fish_seen_subcommand_from {command.name}"
        for option in command.options:
            lines += fish_option(option, condition)
    return NOTE + FISH + "\n".join(lines) + "\n"
