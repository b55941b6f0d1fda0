#!/usr/bin/env python3
"""Measures what the kept inputs of the fuzz targets run, and rewrites the table in README.md: coverage.py FOLDER

FOLDER gets the instrumented programs.  Needs what fuzz.sh needs.
"""
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
LOW = 90  # per cent of lines, below which a source file has a row of its own
TARGETS = "reader", "rows", "writer", "packets", "division", "decoder", "image", "options", "field"
BEGIN, END = "<!-- coverage.py -->\n", "<!-- end -->\n"


def rows_of(target, folder):
    """Lines of the table: source files of which little is run, and the sum of all."""
    report = subprocess.run(["sh", HERE / "fuzz.sh", target, f"{folder}/{target}", "coverage"], check=True, text=True,
                            stdout=subprocess.PIPE).stdout
    inputs = sum(1 for path in (HERE / "corpus" / target).iterdir())
    for line in report.splitlines():
        words = line.split()  # name, then three columns each of regions, functions, lines, branches
        if len(words) != 13 or words[9] == "-":
            continue
        functions, lines, branches = words[6], words[9], words[12]
        is_sum = words[0] == "TOTAL"
        if is_sum or float(lines.rstrip("%")) < LOW:
            name = f"all, {inputs} inputs" if is_sum else f"`{words[0]}`"
            yield f"| {target} | {name} | {functions} | {lines} | {branches} |\n"


def main():
    folder = sys.argv[1]
    table = "| target | source | functions | lines | branches |\n|---|---|---|---|---|\n"
    table += "".join(row for target in TARGETS for row in rows_of(target, folder))
    page = HERE / "README.md"
    text = page.read_text()
    begin, end = text.index(BEGIN) + len(BEGIN), text.index(END)
    page.write_text(text[:begin] + table + text[end:])


if __name__ == "__main__":
    main()
