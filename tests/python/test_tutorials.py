"""The programs of the tutorials run, block after block of a page."""

import os
import pathlib
import subprocess
import sys

import pytest
from PIL import Image

from conftest import make_picture
from tutorials import blocks, pages


@pytest.mark.parametrize("page", [page for page in pages() if blocks(page, "python")], ids=lambda page: page.stem)
def test_programs_run(page: pathlib.Path, tmp_path: pathlib.Path) -> None:
    (tmp_path / "photos").mkdir()
    for name in ("photo.png", "photos/a.png", "photos/b.png"):
        Image.fromarray(make_picture(96, 64)).save(tmp_path / name)
    program = tmp_path / "tutorial.py"
    program.write_text("\n".join(blocks(page, "python")), encoding="utf-8")
    done = subprocess.run([sys.executable, "-W", "error", str(program)], cwd=tmp_path, env={**os.environ}, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
