"""What host/PROMISES.md lists of the program, and what values of JSON have of it."""
import pathlib
import re

PAGE = pathlib.Path(__file__).resolve().parents[2] / "host" / "PROMISES.md"


def table(heading):
    """The rows of the table below a heading, each a list of cells without the marks of code."""
    section = re.search(rf"(?ms)^## {re.escape(heading)}$(.*?)(?=^## |\Z)", PAGE.read_text(encoding="utf-8")).group(1)
    rows = [line.strip("|").split("|") for line in section.splitlines() if line.startswith("|")]
    return [[cell.strip().replace("`", "") for cell in row] for row in rows[2:]]


def listed(heading):
    """By the first column, the words of the last one, which may be spread over the rows of several versions."""
    found = {}
    for name, _, words in table(heading):
        found.setdefault(name, []).extend(words.split(", "))
    return found


def keys(value, path=""):
    """The names of all values: a.b is a member b of a member a, and a[] an element of a list."""
    if isinstance(value, dict):
        return {name for member, inner in value.items() for name in keys(inner, f"{path}.{member}".lstrip("."))}
    if isinstance(value, list):
        return {name for inner in value for name in keys(inner, f"{path}[]")} or {f"{path}[]"}
    return {path}
