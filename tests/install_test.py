"""Installs the build into a temporary folder, and uses what is there.

usage: install_test.py CMAKE BUILD_FOLDER VERSION
What needs a program that is not here is skipped, with a message.
"""
import configparser
import gzip
import os
import pathlib
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as xml

ID = "org.dapple.Dapple"
CMAKE, BUILD, VERSION = sys.argv[1:4]
FILES = f"""
bin/dapple
lib/dapple/dapple_image_formats.so
share/applications/{ID}.desktop
share/bash-completion/completions/dapple
share/dapple/scans/creature.ply
share/dapple/swatches/leopard.png
share/dapple/swatches/pebbles.png
share/doc/dapple/LICENSE
share/doc/dapple/README.md
share/doc/dapple/copyright
share/fish/vendor_completions.d/dapple.fish
share/icons/hicolor/scalable/apps/{ID}.svg
share/man/man1/dapple.1.gz
share/metainfo/{ID}.metainfo.xml
share/mime/packages/{ID}.xml
share/zsh/site-functions/_dapple
"""
PROBE = """
source "$1" || exit 1
shift
COMP_WORDS=("$@")
COMP_CWORD=$((${#COMP_WORDS[@]} - 1))
_dapple
printf '%s\\n' "${COMPREPLY[@]}"
"""


def run(*command, **options):
    done = subprocess.run(
        [str(word) for word in command], capture_output=True, text=True, timeout=300, **options
    )
    return done.returncode, done.stdout + done.stderr


def need(program, package):
    if shutil.which(program) is None:
        raise unittest.SkipTest(f"{program} of Debian's package {package} is not here")


class Installation(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory(prefix="dapple-install-")
        cls.addClassCleanup(cls.folder.cleanup)
        cls.prefix = pathlib.Path(cls.folder.name, "a prefix")
        environment = {name: v for name, v in os.environ.items() if name != "DESTDIR"}
        code, said = run(CMAKE, "--install", BUILD, "--prefix", cls.prefix, env=environment)
        assert code == 0, said
        cls.share = cls.prefix / "share"
        cls.program = cls.prefix / "bin/dapple"
        cls.home = pathlib.Path(cls.folder.name, "home")  # where completions look for files
        (cls.home / "of mine").mkdir(parents=True)
        for name in ("bunny.ply", "Horse.PLY", "teapot.obj", "moss.png", "figures.json",
                     "notes.doc", "of mine/inner.ply"):
            (cls.home / name).touch()

    def check(self, *command, **options):
        code, said = run(*command, **options)
        self.assertEqual(code, 0, f"{command}: {said}")
        return said

    def desktop_entry(self):
        parser = configparser.ConfigParser(interpolation=None)
        parser.optionxform = str
        parser.read(self.share / f"applications/{ID}.desktop", "utf-8")
        return parser["Desktop Entry"]

    def test_every_file_is_there_and_nothing_of_how_it_was_made(self):
        for name in FILES.split():
            self.assertTrue((self.prefix / name).is_file(), name)
        sources = pathlib.Path(__file__).resolve().parents[1]
        swatches = sorted(os.listdir(sources / "assets/swatches"))
        self.assertEqual(sorted(os.listdir(self.share / "dapple/swatches")), swatches)
        made_with = (".py", ".in", ".h", ".a")
        self.assertEqual([p for p in self.prefix.rglob("*") if p.suffix in made_with], [])

    def test_the_program_textures_its_own_scan_with_its_own_swatch(self):
        self.assertEqual(self.check(self.program, "--version").strip(), VERSION)
        result = pathlib.Path(self.folder.name, "out.ply")
        self.check(
            *(self.program, "texture", self.share / "dapple/scans/creature.ply"),
            *("--swatch", self.share / "dapple/swatches/pebbles.png", "--method", "triplanar"),
            # A picture, too: images are written by a module, which has to be found.
            *("-o", result, "--picture", pathlib.Path(self.folder.name, "out.jpg")),
            cwd="/",
        )
        header = result.read_bytes()[:2000]
        self.assertIn(b"element vertex 29945\n", header)
        self.assertIn(b"property uchar red\n", header)

    def test_icons_have_the_sizes_of_their_folders(self):
        for size in (48, 64, 128, 256, 512):
            icon = self.share / f"icons/hicolor/{size}x{size}/apps/{ID}.png"
            self.assertEqual(struct.unpack(">II", icon.read_bytes()[16:24]), (size, size))

    def test_the_desktop_entry_is_valid_and_starts_what_exists(self):
        entry = self.desktop_entry()
        words = entry["Exec"].split()
        self.assertEqual(words[-1], "%F")
        self.assertTrue((self.prefix / "bin" / words[0]).is_file())
        self.assertTrue((self.prefix / "bin" / entry["TryExec"]).is_file())
        self.assertTrue((self.share / f"icons/hicolor/48x48/apps/{entry['Icon']}.png").is_file())
        need("desktop-file-validate", "desktop-file-utils")
        said = self.check("desktop-file-validate", self.share / f"applications/{ID}.desktop")
        self.assertEqual(said, "")

    def test_the_desktop_entry_starts_a_command_that_the_program_has(self):
        command = self.desktop_entry()["Exec"].split()[1]
        self.assertRegex(self.check(self.program, "--help"), rf"(?m)^  {command} ")

    def test_the_metainfo_is_valid_and_tells_this_version(self):
        path = self.share / f"metainfo/{ID}.metainfo.xml"
        root = xml.parse(path).getroot()
        self.assertEqual(root.findtext("id"), ID)
        self.assertEqual(root.findtext("launchable"), f"{ID}.desktop")
        self.assertEqual(root.find("releases/release").get("version"), VERSION)
        need("appstreamcli", "appstream")
        self.check("appstreamcli", "validate", "--no-net", path)

    def test_files_are_of_the_types_that_the_program_opens(self):
        need("update-mime-database", "shared-mime-info")
        self.check("update-mime-database", self.share / "mime")
        globs = (self.share / "mime/globs2").read_text()
        types = self.desktop_entry()["MimeType"].split(";")
        for glob in ("50:application/x-dapple-project:*.dapple", "50:model/x-ply:*.ply",
                     "40:application/x-xyz:*.xyz"):
            self.assertIn(glob + "\n", globs)
            self.assertIn(glob.split(":")[1], types)
        parents = (self.share / "mime/subclasses").read_text()
        self.assertIn("application/x-dapple-project model/x-ply\n", parents)

    def test_the_man_page_tells_every_option_without_a_warning(self):
        path = self.share / "man/man1/dapple.1.gz"
        page = gzip.decompress(path.read_bytes()).decode().replace("\\-", "-")
        listed = self.check(self.program, "--help").split("Subcommands:")[1]
        commands = re.findall(r"^  (\w+) ", listed, re.M)
        self.assertGreaterEqual(len(commands), 4)
        for command in commands:
            self.assertIn(f".SH DAPPLE {command.upper()}", page)
            for option in re.findall(r"--[a-z-]+", self.check(self.program, command, "--help")):
                self.assertIn(f"\\fB{option}\\fR", page, command)
        self.assertNotRegex(page, r"@[A-Z]+@")
        need("man", "man-db")
        environment = {**os.environ, "MANROFFSEQ": "", "LC_ALL": "C.UTF-8"}
        formatted = ("man", "--warnings", "-E", "UTF-8", "-l", "-Tutf8", "-Z", path)
        said = self.check(*formatted, env=environment)
        self.assertEqual([line for line in said.splitlines() if "warning: " in line], [])

    def completed(self, words, *, setup=""):
        script = setup + PROBE
        path = self.share / "bash-completion/completions/dapple"
        said = self.check("bash", "-c", script, "bash", path, *words, cwd=self.home)
        return sorted(said.split("\n")[:-1])

    def test_bash_completes_commands_options_and_values(self):
        cases = (
            (["dapple", ""], ["--help", "--version", "-h", "bake", "field", "info", "render", "score",
                             "synth2d", "texture", "tile"]),
            (["dapple", "te"], ["texture"]),
            (["dapple", "texture", "--me"], ["--method"]),
            (["dapple", "texture", "--no-c"], ["--no-coherent"]),
            (["dapple", "info", "--me"], []),
            (["dapple", "texture", "--method", ""],
             ["auto", "coordinates", "grid", "hybrid", "mapping", "match", "patches", "random",
              "tiling", "triplanar"]),
            (["dapple", "texture", "--method", "=", "tri"], ["triplanar"]),
            (["dapple", "texture", "--tileable", "="], ["auto", "no", "yes"]),
            (["dapple", "--version", "render", "--renderer", "c"], ["cpu"]),
            (["dapple", "texture", "--seed", ""], []),
            (["dapple", "nothing", ""], []),
        )
        for words, expected in cases:
            with self.subTest(words=words):
                found = [word for word in self.completed(words) if word]
                # Commands that come later are welcome.
                self.assertEqual([word for word in found if word in expected], expected)
                if words[1:] != [""]:
                    self.assertEqual(found, expected)

    def test_bash_completes_files_that_the_option_can_take(self):
        scans = ["Horse.PLY", "bunny.ply", "of mine", "teapot.obj"]
        cases = (
            (["dapple", "texture", ""], scans),
            (["dapple", "texture", "--swatch", ""], ["moss.png", "of mine"]),
            (["dapple", "texture", "-o", "b"], ["bunny.ply"]),
            (["dapple", "texture", "--report", "=", "f"], ["figures.json"]),
            (["dapple", "render", "-o", "m"], ["moss.png"]),
            (["dapple", "info", "of mine/"], ["of mine/inner.ply"]),
        )
        for words, expected in cases:
            with self.subTest(words=words):
                self.assertEqual(self.completed(words), expected)

    def test_bash_completes_the_same_files_with_the_help_of_bash_completion(self):
        library = pathlib.Path("/usr/share/bash-completion/bash_completion")
        if not library.exists():
            raise unittest.SkipTest("Debian's package bash-completion is not here")
        cases = (
            (["dapple", "render", ""], ["Horse.PLY", "bunny.ply", "of mine", "teapot.obj"]),
            (["dapple", "texture", "--swatch", "m"], ["moss.png"]),
        )
        for words, expected in cases:
            with self.subTest(words=words):
                self.assertEqual(self.completed(words, setup=f". {library}\n"), expected)

    def test_fish_completes(self):
        need("fish", "fish")
        path = self.share / "fish/vendor_completions.d/dapple.fish"
        cases = (
            ("dapple te", ["texture"]),
            ("dapple texture --meth", ["--method"]),
            ("dapple texture --method tri", ["triplanar"]),
            ("dapple texture --swatch ", ["moss.png", "of mine/"]),
            ("dapple texture ", ["Horse.PLY", "bunny.ply", "of mine/", "teapot.obj"]),
        )
        for line, expected in cases:
            with self.subTest(line=line):
                script = f"source '{path}'; complete -C '{line}'"
                said = self.check("fish", "--no-config", "-c", script, cwd=self.home)
                self.assertEqual(sorted(row.split("\t")[0] for row in said.splitlines()), expected)

    def test_zsh_reads_its_completions(self):
        need("zsh", "zsh")
        self.check("zsh", "-n", self.share / "zsh/site-functions/_dapple")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
