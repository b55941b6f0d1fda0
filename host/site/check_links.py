#!/usr/bin/env python3
"""Checks that each link inside a site leads to a file that it has, and to a place of that page: check_links.py FOLDER

Links to other hosts are not followed.  Prints the links that lead nowhere, and ends with 1 if there are any.
"""
import html.parser
import pathlib
import sys
import urllib.parse


class Page(html.parser.HTMLParser):
    def __init__(self, path):
        super().__init__()
        self.links, self.places = set(), set()
        self.feed(path.read_text(encoding="utf-8", errors="replace"))

    def handle_starttag(self, tag, attributes):
        named = dict(attributes)
        self.places.update(named[key] for key in ("id", "name") if named.get(key))
        self.links.update(named[key] for key in ("href", "src") if named.get(key))


def broken(path, link, pages):
    """Why a link of a page leads nowhere; None where it does not."""
    parts = urllib.parse.urlsplit(link)
    if parts.scheme or parts.netloc:
        return None
    target = path.parent.joinpath(urllib.parse.unquote(parts.path)).resolve() if parts.path else path
    target = target / "index.html" if target.is_dir() else target
    if not target.is_file():
        return "no such file"
    place = urllib.parse.unquote(parts.fragment)
    return "no such place" if place and target in pages and place not in pages[target].places else None


def main():
    folder = pathlib.Path(sys.argv[1]).resolve()
    pages = {path: Page(path) for path in folder.rglob("*.html")}
    wrong = [(path.relative_to(folder), link, why) for path, page in sorted(pages.items()) for link in sorted(page.links)
             if (why := broken(path, link, pages))]
    for path, link, why in wrong:
        print(f"{path}: {link}: {why}")
    print(f"{len(pages)} pages, {sum(len(page.links) for page in pages.values())} links, {len(wrong)} lead nowhere")
    sys.exit(1 if wrong or not pages else 0)


if __name__ == "__main__":
    main()
