"""The blocks of code of the tutorials, host/site/tutorials."""
import pathlib
import re

FOLDER = pathlib.Path(__file__).resolve().parents[2] / "host/site/tutorials"
LANGUAGES = {"sh", "python", "js"}  # of which tests run all blocks


def pages():
    return sorted(FOLDER.glob("*.md"))


def blocks(page, language=None):
    """Pairs of language and code, or the code of one language."""
    found = re.findall(r"^```(\w*)\n(.*?)^```$", page.read_text(encoding="utf-8"), re.M | re.S)
    return [code for name, code in found if name == language] if language else found
