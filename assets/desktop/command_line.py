"""Reads a program's command line from its own --help, as CLI11 prints it."""
import dataclasses
import re
import subprocess

# Files are known by what an option's help calls them: by formats, or else by the first such word.
FORMATS = {
    "PLY": ("ply",),
    "OBJ": ("obj",),
    "XYZ": ("xyz", "xyzn", "xyzrgb", "pts", "asc", "txt", "csv"),
    "JSON": ("json",),
    "project": ("dapple",),
}
WORDS = {
    "scan": FORMATS["PLY"] + FORMATS["OBJ"] + FORMATS["XYZ"],
    "image": ("png", "jpg", "jpeg", "tif", "tiff", "exr", "bmp", "tga", "webp", "hdr", "gif"),
}
COLUMN = 30  # where CLI11 begins the help of an option, on the next line if its name is long


@dataclasses.dataclass
class Option:
    names: list  # "-o", "--output"; of a positional its bare name
    off: list  # of a flag, the names that switch it off
    value: str  # what CLI11 calls the value: TEXT, "8 to 128", "a|b"; "" for a flag
    default: str
    required: bool
    notes: list  # "Needs: --target"
    help: str

    @property
    def positional(self):
        return not self.names[0].startswith("-")

    @property
    def choices(self):
        """The words that the value can be, listed with | by its type or else by its help."""
        for text in (self.value, self.help if self.value == "TEXT" else ""):
            listed = re.search(r"[\w#,-]+(?:\|[\w#,-]+)+", text)
            if listed:
                words = listed.group().split("|")
                return [word for word in words if re.fullmatch(r"[a-z][\w-]*", word)]
        return []

    @property
    def extensions(self):
        """Of the files that the value can name; empty when it names none."""
        if self.value != "TEXT" or self.choices:
            return []
        formats = [kind for kind in FORMATS if re.search(rf"\b{kind}\b", self.help)]
        if formats:
            return [extension for kind in formats for extension in FORMATS[kind]]
        word = re.search(rf"\b({'|'.join(WORDS)})s?\b", self.help)
        return list(WORDS[word.group(1)]) if word else []


@dataclasses.dataclass
class Command:
    name: str  # "" for the program itself
    help: str
    options: list

    @property
    def positionals(self):
        return [option for option in self.options if option.positional]

    @property
    def named(self):
        return [option for option in self.options if not option.positional]


def printed(program, *arguments):
    ran = subprocess.run([program, *arguments], check=True, capture_output=True, text=True)
    return ran.stdout


def sections(text):
    """{title: [[left column, help], ...]} of the lists below the usage line."""
    found, entries = {}, None
    for line in text.splitlines():
        if line.endswith(":") and not line.startswith(" "):
            entries = found.setdefault(line[:-1], [])
        elif entries is not None and line.startswith(" " * COLUMN):
            entries[-1] = ["".join(entries[-1]).rstrip(), line.strip()]
        elif entries is not None and line.strip():
            entries.append([line[:COLUMN], line[COLUMN:].rstrip()])
    return found


def parse_option(left, text):
    words = left.split()
    names = words[0].split(",")
    off = [name[: -len("{false}")] for name in names if name.endswith("{false}")]
    value = " ".join(words[1:])
    notes = re.findall(r"(?:Needs|Excludes): \S+(?: -\S+)*", value)
    value = re.sub(r"\s*(?:Needs|Excludes): \S+(?: -\S+)*", "", value)
    required = " REQUIRED" in value
    value = value.replace(" REQUIRED", "").removesuffix(" ...")
    value, _, default = value.partition("=")
    value = re.sub(r"^\w+:.* in \[(\S+) - (\S+)\]$", r"\1 to \2", value)
    return Option(
        names=[name for name in names if not name.endswith("{false}")],
        off=off,
        value=value,
        default=default,
        required=required,
        notes=notes,
        help=text,
    )


def parse_command(name, text):
    lists = sections(text)
    return Command(
        name=name,
        help=text.splitlines()[0],
        options=[
            parse_option(left, option_help)
            for title in ("Positionals", "Options")
            for left, option_help in lists.get(title, [])
        ],
    )


def read_command_line(program):
    """The program and its commands, and what --version prints."""
    text = printed(program, "--help")
    names = [left.split()[0] for left, _ in sections(text).get("Subcommands", [])]
    commands = [parse_command(name, printed(program, name, "--help")) for name in names]
    return parse_command("", text), commands, printed(program, "--version").strip()
