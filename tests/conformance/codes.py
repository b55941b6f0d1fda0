"""The program of codes.c.  Where it was built for another machine it runs in the emulator that meson names."""
import os
import pathlib
import re
import shlex
import struct
import subprocess

BATCH = 100  # files of one call: the length of a command line is limited


class Codes:
    def __init__(self, path):
        emulator = shlex.split(os.environ.get("MESON_EXE_WRAPPER", ""))
        self.command = [*emulator, str(path)]
        self.is_emulated = bool(emulator)

    def run(self, *words):
        """Returns what it prints."""
        return subprocess.run([*self.command, *map(str, words)], check=True, stdout=subprocess.PIPE, text=True).stdout

    def sections(self, words, paths):
        """What it prints of each file: the words after "file NAME", and the lines that follow."""
        for first in range(0, len(paths), BATCH):
            parts = re.split(r"^file ", self.run(*words, *paths[first:first + BATCH]), flags=re.M)[1:]
            for part in parts:
                line, rest = part.split("\n", 1)
                yield line.split()[1:], rest

    def read(self, bare, paths):
        """The result of each file, and its codes as text."""
        for (result,), text in self.sections(["read", form(bare)], paths):
            yield result, text

    def prefixes(self, bare, paths):
        """The lines about the prefixes of each file."""
        for _, text in self.sections(["prefixes", form(bare)], paths):
            yield text.splitlines()

    def decode(self, decoder, bare, paths, folder):
        """Of each file its result; of a valid one its size, as width, height, channels and depth, and its samples.  `decoder` is
        one of the words of codes.c, `folder` holds the samples for a while."""
        for number, ((result, *size), _) in enumerate(self.sections([decoder, form(bare), folder], paths)):
            size = [*map(int, size)]
            yield result, size, read_samples(pathlib.Path(folder, f"{number % BATCH}.raw"), size[3]) if size else []

    def pixels(self, bare, path, places):
        """Of single pixels the depth and the samples, from the device "host"."""
        numbers = [number for place in places for number in place]
        for line in self.run("pixels", form(bare), path, *numbers).splitlines():
            depth, *samples = map(int, line.split())
            yield depth, samples


def form(bare):
    return "bare" if bare else "whole"


def read_samples(path, depth):
    data = path.read_bytes()
    return list(data) if depth == 8 else list(struct.unpack(f"<{len(data) // 2}H", data))
