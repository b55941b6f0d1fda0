"""Manual pages and completions, which the program makes from the same tables as its help texts.

DOCUMENTS names the folder where the build puts them.
"""
import os
import pathlib
import re
import shutil
import subprocess
import unittest

from tool import TIMEOUT, ToolTest, main

DOCUMENTS = pathlib.Path(os.environ["DOCUMENTS"])


def needs(program):
    return unittest.skipUnless(shutil.which(program), f"needs {program}")


def run(*command):
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, timeout=TIMEOUT)
    return done.returncode, done.stdout, done.stderr


class Documents(ToolTest):
    def commands(self):
        return [line.split("\t")[0] for line in self.gscl("--help=commands").decode().splitlines()]

    def options(self, command):
        """The long options in the help text of a command."""
        text = self.gscl(command, "-h").decode().split("\n\n", 2)[-1]
        return re.findall(r"^  (?:-\w, |    )--([\w-]+)", text, flags=re.M)

    def test_examples_of_pages_keep_their_lines(self):
        page = self.gscl("encode", "--help=man").decode()
        self.assertRegex(page, r"\n\.nf\n  find photos [^\n]* \|\n      gscl encode [^\n]*coded\.jsonl\n\.fi\n")

    def test_every_command_has_a_page(self):
        pages = {path.name for path in DOCUMENTS.glob("*.1")}
        self.assertEqual(pages, {"gscl.1"} | {f"gscl-{command}.1" for command in self.commands()})
        usage = self.gscl("help").decode()
        for command in self.commands():
            self.assertRegex(usage, rf"\n  {command} ")

    @needs("mandoc")
    @needs("man")
    def test_pages_are_valid(self):
        for page in DOCUMENTS.glob("*.1"):
            with self.subTest(page=page.name):
                _, warnings, _ = run("mandoc", "-T", "lint", "-W", "warning", page)
                # A page that depends on the sources alone has no date.
                others = [line for line in warnings.splitlines() if "missing date" not in line]
                self.assertEqual(others, [])
                self.assertEqual(run("man", "--warnings", "-E", "UTF-8", "-l", "-Tutf8", page)[2], "")

    @needs("man")
    def test_pages_say_what_the_help_says(self):
        for command in self.commands():
            with self.subTest(command=command):
                text = run("mandoc", "-T", "utf8", "-O", "width=1000", DOCUMENTS / f"gscl-{command}.1")[1]
                plain = " ".join(re.sub(r".\x08", "", text).split())
                for line in self.gscl(command, "-h").decode().splitlines():
                    words = re.sub(r"^  (?:-\w, |    )--\S+( [A-Z]\S*)?( |$)", "", line) if line.startswith("  -") else line
                    if words.strip() and not line.startswith("usage:") and "print this text" not in line:
                        self.assertIn(" ".join(re.sub(r"^.*?  +", "", words).split())[:60], plain)
                for option in self.options(command):
                    self.assertIn(f"--{option}", plain)

    def test_examples_can_be_pasted(self):
        """Debian's man prints ' as it is, others as a typographic one unless it is written so."""
        page = (DOCUMENTS / "gscl-encode.1").read_text()
        self.assertIn(r"find photos \-name \(aq*.jpg\(aq \-print0 |", page)

    def test_unknown_form(self):
        self.refused("encode", "--help cannot be 'text'; it takes man or options", "encode", "--help=text", code=2)

    def complete(self, *words):
        script = (f'source "{DOCUMENTS}/gscl"; COMP_WORDS=({" ".join(words)} "{{last}}"); COMP_CWORD={len(words)}; _gscl; '
                  'printf "%s\\n" "${COMPREPLY[@]}"')
        return lambda last: set(run("bash", "-c", script.replace("{last}", last))[1].split())

    @needs("bash")
    def test_bash(self):
        self.assertEqual(run("bash", "-n", DOCUMENTS / "gscl"), (0, "", ""))
        self.assertEqual(self.complete("gscl")("de"), {"decode", "devices"})
        self.assertEqual(self.complete("gscl")(""), {*self.commands(), "help"})
        for command in self.commands():
            self.assertEqual(self.complete("gscl", command)("--"), {f"--{option}" for option in self.options(command)})
        self.assertEqual(self.complete("gscl", "encode", "--tune")(""), {"auto", "psnr", "ssim", "visual"})
        self.assertEqual(self.complete("gscl", "encode", "--effort")(""), set())
        self.assertIn(str(DOCUMENTS / "gscl.1"), self.complete("gscl", "decode", "-o")(f"{DOCUMENTS}/gscl."))

    @needs("zsh")
    def test_zsh(self):
        self.assertEqual(run("zsh", "-n", DOCUMENTS / "_gscl"), (0, "", ""))
        text = (DOCUMENTS / "_gscl").read_text()
        for command in self.commands():
            for option in self.options(command):
                self.assertIn(f"--{option}[", text)

    @needs("fish")
    def test_fish(self):
        def complete(line):
            _, out, error = run("fish", "--no-config", "-c", f"source {DOCUMENTS}/gscl.fish; complete -C '{line}'")
            self.assertEqual(error, "")
            return {word.split("\t")[0] for word in out.splitlines()}
        self.assertEqual(complete("gscl de"), {"decode", "devices"})
        self.assertEqual(complete("gscl encode --tune "), {"auto", "psnr", "ssim", "visual"})
        self.assertEqual(complete("gscl decode --"), {f"--{option}" for option in self.options("decode")})


if __name__ == "__main__":
    main()
