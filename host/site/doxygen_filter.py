#!/usr/bin/env python3
"""Prints a public header with its comments in the form that Doxygen reads: doxygen_filter.py HEADER

A comment behind code is about the code on its line, any other about what follows it; headings of sections and comments behind #if,
#endif and the like stay comments.  Paragraphs that are indented are code.
"""
import re
import sys

COMMENT = re.compile(r"/\*(.*?)\*/", re.S)
LIST = re.compile(r"^(\s+\w+ \w+(?:, \w+)+;) *(/\*\*<.*?\*/)", re.M | re.S)
SPECIAL = re.compile(r"[\\@<>#&%$\"]")


def lines_of(comment):
    """Its lines without the stars at their starts."""
    first, *others = comment.split("\n")
    return [first.strip()] + [re.sub(r"^\s*\* ?", "", line).rstrip() if line.lstrip().startswith("*") else line.strip() for line in others]


def escaped(line):
    return SPECIAL.sub(lambda match: "\\" + match.group(), line)


def text_of(lines):
    """The lines for Doxygen, as many as there were: those that tell of errors then name the lines of the header."""
    text, is_code = [], False
    for line in lines:
        code = line.startswith("    ")
        mark = "\\code{.c} " if code and not is_code else "\\endcode " if is_code and not code and line.strip() else ""
        is_code = code or (is_code and not line.strip())
        text.append(mark + (line if code else escaped(line)))
    return "\n".join(text) + (" \\endcode" if is_code else "")


def each_with(declaration, comment):
    """Of "type a, b;" each name with the comment, which Doxygen otherwise takes for the last one's."""
    kind, names = re.fullmatch(r"(\s*[\w ]+?)\s+(\w+(?:, \w+)*);\s*", declaration).groups()
    return " ".join(f"{kind} {name}; {comment}" for name in names.split(", "))


def converted(match):
    source, before = match.string, match.string[match.string.rfind("\n", 0, match.start()) + 1:match.start()]
    text = text_of(lines_of(match.group(1)))
    if text.lstrip().startswith("----") or re.match(r"\s*#\s*(if|ifdef|ifndef|elif|else|endif)\b", before):
        return match.group()
    if match.start() == 0:
        return f"/** \\file\n{text}*/"
    following = source[match.end():].lstrip(" ")
    behind = bool(before.strip()) and following.startswith("\n")
    return f"/**{'<' if behind else ''} {text} */"


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        text = COMMENT.sub(converted, file.read())
        print(LIST.sub(lambda match: each_with(*match.groups()), text), end="")


if __name__ == "__main__":
    main()
