"""Compares all decoders on 200 random files, some of them damaged or divided into packets: test_differential.py CODES [TEST...]

CODES is the program of codes.c; the environment variable GSCL_WEB names the folder of the decoder for web pages.
differential.py compares more files.
"""
import os
import pathlib
import sys
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "cli")]

from codes import Codes
from differential import EXACT, WEB, WORDS, Comparison
from tool import main

CODES = Codes(sys.argv.pop(1))

FILES = 200
KINDS = 20  # of files, because kernels are compiled for each


class Differential(unittest.TestCase):
    def test_decoders_agree(self):
        web = os.environ.get("GSCL_WEB")
        comparison = Comparison(CODES, web, KINDS)
        comparison.add(range(FILES))
        for line in comparison.report():
            print("#", line)
        self.assertEqual([file.problems for file in comparison.failed], [])
        self.assertEqual(comparison.valid, FILES)
        self.assertGreater(comparison.lists, FILES // 5)
        self.assertGreater(comparison.drawn, FILES - 1)
        decoders = {WORDS[word] for word in CODES.run("decoders").split()} | ({WEB} if web else set())
        self.assertEqual({b for a, b in comparison.largest if a == EXACT}, decoders)
        self.assertTrue({"corrupt", "truncated", "damaged", "valid"} <= set(comparison.results))


if __name__ == "__main__":
    main()
