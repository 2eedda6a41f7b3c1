#!/usr/bin/env python3
"""Writes the man page and the shell completions from a program's own --help.

usage: make_command_docs.py PROGRAM FOLDER
Into FOLDER: dapple.1.gz, dapple.bash, dapple.zsh, dapple.fish.
"""
import gzip
import pathlib
import re
import sys

import command_line
import completions

TEMPLATE = pathlib.Path(__file__).with_name("dapple.1.in")


def roff(text):
    escaped = text.replace("\\", "\\e").replace("-", "\\-").replace("'", "\\(aq")
    return "\\&" + escaped if escaped.startswith(".") else escaped


def value_name(option):
    """What stands for the option's value; "" for a flag."""
    value = option.value
    if "|" in value:
        return value
    if value.startswith("x,y,z") or value.endswith(" x 3"):
        return "x,y,z"
    if value != "TEXT":
        return "N" if value else ""
    if option.choices:
        return "WORD"
    if len(option.extensions) == 1:
        return "FILE." + option.extensions[0]
    metavariable = re.search(r"\b[A-Z]+x[A-Z]+\b", option.help)
    return "FILE" if option.extensions else metavariable.group() if metavariable else "TEXT"


def option_entry(option):
    """The help as it is, then range, conditions and default."""
    names = ", ".join(rf"\fB{roff(name)}\fR" for name in option.names + option.off)
    value = value_name(option)
    text, _, default = option.help.partition(" [")
    remarks = [option.value] if " to " in option.value else re.findall(r"\((.*)\)", option.value)
    remarks += [note.replace(": ", " ").lower() for note in option.notes]
    default = option.default or default.rstrip("]")
    remarks += [f"default {default}"] if default else []
    if not re.match(r"[\w,]+[|:]", text):  # the name of a value, or of the method that is meant
        text = text[:1].upper() + text[1:]
    text += f" ({'; '.join(remarks)})" if remarks else ""
    if option.positional:
        return [".TP", rf"\fI{roff(option.names[0].upper())}\fR", roff(text) + "."]
    return [".TP", names + (rf" \fI{roff(value)}\fR" if value else ""), roff(text) + "."]


def synopsis(command):
    words = [rf"\fBdapple {command.name}\fR"]
    for option in command.positionals:
        word = rf"\fI{roff(option.names[0].upper())}\fR"
        words.append(word if option.required else f"[{word}]")
    for option in command.named:
        if option.required:
            words.append(rf"\fB{roff(option.names[0])}\fR \fI{roff(value_name(option))}\fR")
    return " ".join(words) + r" [\fIoptions\fR]"


def man_page(commands, version):
    shared = [
        option
        for option in commands[0].named
        if all(option in command.named for command in commands[1:])
    ]
    sections = []
    for command in commands:
        sections += [f".SH DAPPLE {command.name.upper()}", synopsis(command)]
        sections += [".PP", roff(command.help)]
        for option in command.options:
            if option not in shared:
                sections += option_entry(option)
    values = {
        "VERSION": version,
        "SYNOPSIS": "\n.br\n".join([synopsis(command) for command in commands]),
        "COMMANDS": "\n".join(sections),
        "COMMON": "\n".join(line for option in shared for line in option_entry(option)),
    }
    return re.sub(r"@([A-Z]+)@", lambda match: values[match.group(1)], TEMPLATE.read_text("utf-8"))


def main():
    program, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    whole, commands, version = command_line.read_command_line(program)
    folder.mkdir(parents=True, exist_ok=True)
    page = man_page(commands, version)
    # No name and no time inside: the same program gives the same bytes.
    (folder / "dapple.1.gz").write_bytes(gzip.compress(page.encode(), mtime=0))
    for shell in ("bash", "zsh", "fish"):
        text = getattr(completions, shell)(whole, commands)
        (folder / f"dapple.{shell}").write_text(text, "utf-8")


if __name__ == "__main__":
    main()
