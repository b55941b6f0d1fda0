"""The scripts of tests/bench replace marked sections of a document, and nothing else."""
import pathlib
import subprocess
import sys
import unittest

from images import scene
from tool import GSCL, ToolTest, main

BENCH = pathlib.Path(__file__).parent.parent / "bench"
DOCUMENT = "# Figures\n\n<!-- rates -->\nold\n<!-- /rates -->\n\n<!-- efforts -->\nkept\n<!-- /efforts -->\n"


class BenchScripts(ToolTest):
    def run_script(self, name, *arguments):
        return subprocess.run([sys.executable, BENCH / f"{name}.py", self.folder, "--gscl", GSCL, *arguments],
                              cwd=self.folder, capture_output=True, text=True)

    def test_replaces_its_section_alone(self):
        self.write_png("a.png", scene(32, 32))
        self.write("page.md", DOCUMENT.encode())
        done = self.run_script("rate_distortion", "--rates", "4", "--document", "page.md", "--", "--effort", "0")
        self.assertEqual(done.returncode, 0, done.stderr)
        before, rest = DOCUMENT.split("old\n")
        text = self.path("page.md").read_text()
        self.assertTrue(text.startswith(before) and text.endswith(rest), text)
        section = text[len(before):-len(rest)]
        self.assertEqual(section, done.stdout)
        self.assertIn("rate_distortion.py FOLDER -- --effort 0`, 1 image.", section)
        self.assertEqual(sum(line.endswith("| 0 of 1 |") for line in section.splitlines()), 1, section)

    def test_prints_without_a_document(self):
        self.write_png("a.png", scene(32, 32))
        done = self.run_script("rate_distortion", "--rates", "4", "--", "--effort", "0")
        self.assertEqual((done.returncode, self.files()), (0, ["a.png"]), done.stderr)

    def test_refuses_a_document_without_the_section(self):
        self.write("page.md", DOCUMENT.encode())
        done = self.run_script("ablation", "--document", "page.md")
        self.assertEqual(done.returncode, 1)
        self.assertIn("page.md: needs one section between <!-- ablation --> and <!-- /ablation -->", done.stderr)


if __name__ == "__main__":
    main()
