#!/usr/bin/env python3
"""host/site/check_links.py finds links that lead nowhere, and no others."""
import pathlib
import subprocess
import sys
import tempfile

PROGRAM = pathlib.Path(__file__).resolve().parents[2] / "host/site/check_links.py"
GOOD = '<h1 id="top">A</h1><a href="#top"></a><a href="b/#part"></a><a href="https://example.org/x"></a><img src="b/%20.png">'


def check(body):
    """The exit code and the links that are named, for a page a.html beside b/index.html."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "b").mkdir()
        (folder / "b/index.html").write_text('<p id="part"></p>')
        (folder / "b/ .png").write_bytes(b"")
        (folder / "a.html").write_text(body)
        done = subprocess.run([sys.executable, PROGRAM, folder], capture_output=True, text=True)
        return done.returncode, [line.split(": ")[1] for line in done.stdout.splitlines()[:-1]]


def main():
    assert check(GOOD) == (0, []), check(GOOD)
    for link in ("c.html", "b/c.png", "b/#other", "#bottom", "b/index.html#x"):
        for tag in (f'<a href="{link}">', f'<img src="{link}">'):
            assert check(GOOD + tag) == (1, [link]), (tag, check(GOOD + tag))


if __name__ == "__main__":
    main()
