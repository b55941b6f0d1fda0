"""Writes measured sections into the Markdown documents beside the scripts.

A document marks each section that a script writes:

    <!-- NAME -->
    text that the script replaces
    <!-- /NAME -->
"""
import datetime
import os
import pathlib
import re
import sys
import tempfile

HERE = pathlib.Path(__file__).parent
CORES = len(os.sched_getaffinity(0))


class Section:
    """A marked section.  The document is checked at once, so that a wrong name fails before anything is measured."""

    def __init__(self, path, name):
        self.path, self.name = pathlib.Path(path), name
        try:
            text = self.path.read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise SystemExit(f"{path}: cannot be read: {error}; name a Markdown document") from error
        if len(self._pattern().findall(text)) != 1:
            raise SystemExit(f"{path}: needs one section between <!-- {name} --> and <!-- /{name} -->")

    def _pattern(self):
        name = re.escape(self.name)
        return re.compile(rf"(?s)(<!-- {name} -->\n).*?(<!-- /{name} -->)")

    def replace(self, text):
        """Replaces the section and leaves the rest of the document as it is."""
        document = self.path.read_text(encoding="utf-8")
        text = text.rstrip("\n") + "\n"
        self.path.write_text(self._pattern().sub(lambda match: match[1] + text + match[2], document), encoding="utf-8")


def add_option(parser, default, section):
    """Adds --document [FILE] to a script whose section stands in `default`, a document beside the scripts."""
    parser.add_argument("--document", metavar="FILE", nargs="?", const=HERE / default,
                        help=f"replace the section '{section}' of this Markdown document (without FILE: tests/bench/{default})")
    parser.set_defaults(section=section)


def section_of(arguments):
    """The section that the command line names, or None when the script only prints."""
    return Section(arguments.document, arguments.section) if arguments.document else None


def publish(section, *parts):
    """Prints the parts of a section, separated by blank lines, and writes them into the document if there is one."""
    text = "\n".join(parts)
    if section:
        section.replace(text)
    print(text, end="")


def table(head, rows):
    """A Markdown table of text cells."""
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows]) + "\n"


def processor():
    for line in pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return "unknown processor"


def origin(command, images):
    """The line above a table: when, where and by which command it was measured."""
    return f"{datetime.date.today()}, {processor()}, {CORES} cores; `{command}`, {images} image{'' if images == 1 else 's'}.\n"


def write_section(arguments, images, head, measure):
    """Writes the table of `measure(folder)`, which gives its rows of text cells and may use the temporary folder."""
    section = section_of(arguments)
    with tempfile.TemporaryDirectory() as folder:
        rows = list(measure(pathlib.Path(folder)))
    command = f"tests/bench/{pathlib.Path(sys.argv[0]).name} FOLDER"
    publish(section, origin(command, len(images)), table(head, rows))
