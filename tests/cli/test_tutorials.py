"""The commands of the tutorials run, block after block of a page, on small pictures.

tests/python/test_tutorials.py and tests/web/test_tutorials.mjs run the other blocks.
"""
import os
import pathlib

from images import scene
from tool import GSCL, ToolTest, main
from tutorials import LANGUAGES, blocks, pages


class Tutorials(ToolTest):
    def run_page(self, page):
        (self.folder / "photos").mkdir(exist_ok=True)
        for name in ("photo.png", "thumbnail.png", "photos/a.png", "photos/b.png"):
            self.write_png(name, scene(96, 64))
        search = {"PATH": f"{pathlib.Path(GSCL).parent}:{os.environ['PATH']}"}
        for code in blocks(page, "sh"):
            done = self.start("-euc", code, program="sh", env=search)
            self.assertEqual((done.returncode, done.stderr.decode() if done.returncode else ""), (0, ""), code)

    def test_commands_run(self):
        self.assertGreaterEqual(len(pages()), 5)
        for page in pages():
            with self.subTest(page.name):
                self.run_page(page)

    def test_each_block_is_run_by_a_test(self):
        for page in pages():
            for language, code in blocks(page):
                self.assertIn(language, LANGUAGES, f"{page.name}: {code}")


if __name__ == "__main__":
    main()
