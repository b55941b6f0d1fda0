"""The programs that list_programs prints."""
import collections
import os
import subprocess

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))

# A line of list_programs.
Program = collections.namedtuple("Program", "mapping set kind use files options")


def read(command):
    lines = subprocess.run([command], check=True, capture_output=True, text=True).stdout.splitlines()
    return [Program(mapping, set_, kind, use, files.split(), options.split())
            for mapping, set_, kind, use, files, options in (line.split("\t") for line in lines)]


def write_source(path, files):
    """As the library gives the files to the compiler (cl/embed.py)."""
    with open(path, "w", encoding="ascii") as source:
        for name in files:
            with open(os.path.join(ROOT, "cl", name), encoding="ascii") as file:
                source.write(f'#line 1 "cl/{name}"\n' + file.read())
