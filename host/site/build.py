#!/usr/bin/env python3
"""Writes the pages of the site: build.py OUT --gscl PROGRAM

Each Markdown document of the source tree becomes a page at its own place in OUT, so that the links between documents stay what they are; files
that documents link to or show are copied.  The program prints its manual pages.  OUT has the references of build.sh already.
"""
import argparse
import html
import pathlib
import re
import shutil
import subprocess
import urllib.parse

import markdown

ROOT = pathlib.Path(__file__).resolve().parents[2]
START = "host/site/index.md"
LINK = re.compile(r'(href|src)="([^"]*)"')
PAGE = """<!doctype html>
<html lang="en"><meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title><link rel="stylesheet" href="{top}style.css">
<nav><a href="{top}index.html">gscl</a> {links}</nav>
<main>
{body}
</main></html>
"""
NAVIGATION = {
    "tutorials": "index.html#tutorials", "C": "c/index.html", "Python": "python/index.html", "web": "web/index.html",
    "program": "man/gscl.1.html", "format": "format/FORMAT.html", "promises": "host/PROMISES.html",
}


def documents():
    """The Markdown documents that git has, or a source tree without git."""
    listed = subprocess.run(["git", "ls-files", "*.md"], cwd=ROOT, capture_output=True, text=True)
    names = listed.stdout.split() if listed.returncode == 0 else [str(path.relative_to(ROOT)) for path in ROOT.rglob("*.md")]
    return [name for name in names if not name.startswith("build")]


def page_of(name):
    return "index.html" if name == START else str(pathlib.PurePosixPath(name).with_suffix(".html"))


def between(page, target):
    """The link from a page to another file of the site."""
    return "../" * page.count("/") + target


class Site:
    def __init__(self, out):
        self.out, self.names = out, set(documents())

    def write(self, page, title, body, references=NAVIGATION):
        links = " ".join(f'<a href="{between(page, target)}">{name}</a>' for name, target in references.items() if self.has(target))
        path = self.out / page
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(PAGE.format(title=html.escape(title), top=between(page, ""), links=links, body=body), encoding="utf-8")

    def has(self, target):
        """Whether the site has a page of the navigation: references may be left out."""
        folder = target.split("/")[0]
        return folder not in ("c", "python", "web", "man") or (self.out / folder).exists()

    def target(self, name, link):
        """Where a link of a document leads to on the site."""
        parts = urllib.parse.urlsplit(link)
        if parts.scheme or parts.netloc or not parts.path:
            return link
        if name == START and parts.path.split("/")[0] in ("c", "python", "web", "man"):
            return link
        path = (ROOT / name).parent.joinpath(urllib.parse.unquote(parts.path)).resolve()
        if path.is_dir():  # its README, or the first of its documents
            path = min(path.glob("*.md"), key=lambda page: (page.name != "README.md", page.name), default=path)
        if not path.is_file():
            raise SystemExit(f"{name}: the link {link} leads to no document and no file")
        found = path.relative_to(ROOT).as_posix()
        if found in self.names:
            found = page_of(found)
        else:
            copy = self.out / found
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(path, copy)
        return between(page_of(name), found) + (f"#{parts.fragment}" if parts.fragment else "")

    def convert(self, name):
        text = (ROOT / name).read_text(encoding="utf-8")
        body = markdown.markdown(text, extensions=["tables", "fenced_code", "toc", "sane_lists", "md_in_html"])
        body = LINK.sub(lambda match: f'{match[1]}="{html.escape(self.target(name, html.unescape(match[2])))}"', body)
        heading = re.search(r"^# (.*)", text, re.M)
        self.write(page_of(name), heading[1] if heading else name, body)

    def convert_manual(self, name, *command):
        """The manual page that a command prints."""
        page = subprocess.run([*command, "--help=man"], check=True, capture_output=True).stdout
        convert = ["mandoc", "-T", "html", "-O", "fragment,man=%N.%S.html"]
        self.write(f"man/{name}.1.html", name, subprocess.run(convert, input=page, check=True, capture_output=True).stdout.decode())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--gscl", required=True)
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    site = Site(options.out)
    shutil.copyfile(pathlib.Path(__file__).with_name("style.css"), options.out / "style.css")
    (options.out / "man").mkdir(exist_ok=True)
    commands = subprocess.run([options.gscl, "--help=commands"], check=True, capture_output=True, text=True).stdout
    site.convert_manual("gscl", options.gscl)
    for name in (line.split("\t")[0] for line in commands.splitlines()):
        site.convert_manual(f"gscl-{name}", options.gscl, name)
    for name in sorted(site.names):
        site.convert(name)


if __name__ == "__main__":
    main()
