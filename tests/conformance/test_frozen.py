"""The format is frozen (host/PROMISES.md, "The format"): test_frozen.py [--update]

frozen.txt has a line for each entry of the conformance set: the SHA-256 of its file, of what index.json expects of it and of its drawn
picture, and its name.  An entry that differs or is missing breaks the promise.  --update adds lines for new entries, and changes none.
"""
import hashlib
import json
import pathlib
import sys
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "cli"))

from tool import main

FROZEN = HERE / "frozen.txt"
ROOT = HERE.parents[1]


def file_of(entry):
    return HERE / "files" / (entry["file"] + (".gsclp" if entry.get("packets") else ".gscl"))


def name_of(entry):
    """A file may be in the set twice, as a whole one and as a bare one."""
    return file_of(entry).name + (" bare" if entry["bare"] else "")


def hash_of(entry):
    expected = {key: value for key, value in entry.items() if key != "about"}
    digest = hashlib.sha256(file_of(entry).read_bytes())
    digest.update(json.dumps(expected, sort_keys=True).encode())
    if "picture" in entry:
        digest.update((HERE / "pictures" / entry["picture"]).read_bytes())
    return digest.hexdigest()


def current():
    entries = json.loads((HERE / "index.json").read_text())
    return {name_of(entry): hash_of(entry) for entry in entries}


def frozen():
    lines = FROZEN.read_text().splitlines() if FROZEN.exists() else []
    return {name: digest for digest, name in (line.split(" ", 1) for line in lines)}


class Frozen(unittest.TestCase):
    def test_entries_are_those_of_version_2(self):
        has = current()
        broken = [name for name, digest in frozen().items() if has.get(name) != digest]
        self.assertEqual(broken, [], "the format is frozen at version 2 (host/PROMISES.md, \"The format\"): these entries have changed")

    def test_each_entry_is_frozen(self):
        self.assertEqual(sorted(set(current()) - set(frozen())), [], "new entries: python3 tests/conformance/test_frozen.py --update")

    def test_version_is_2(self):
        self.assertIn("#define GSF_VERSION 2\n", (ROOT / "format/types.h").read_text())
        self.assertTrue((ROOT / "format/FORMAT.md").read_text().startswith("# The gscl file format, version 2\n"))


def update():
    lines = {**current(), **frozen()}
    FROZEN.write_text("".join(f"{digest} {name}\n" for name, digest in lines.items()))


if __name__ == "__main__":
    if sys.argv[1:] == ["--update"]:
        update()
    else:
        main()
