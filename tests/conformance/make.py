#!/usr/bin/env python3
"""Makes the conformance set: make.py CODES, where CODES is the program that meson builds from codes.c.

Valid files are written by the library from codes as text; files that no writer makes are forged symbol by symbol.  What is
expected of each comes from the decoder in ../decoder, which was written from the page.  test_conformance.py compares both.
"""
import itertools
import json
import os
import pathlib
import random
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "decoder"), str(HERE.parent / "cli")]

import gscl_decoder as gscl
import gscl_file
from codes import Codes
from packet_lists import packet_lists
from scene import ALPHA, DEFAULT_STEPS, GREY, GREY_ALPHA, NORMALIZED, OCTAVES, RGB, RGB_ALPHA, SUM, Scene

MAX_DRAWN = 4096  # pixels: larger pictures are not kept, but some of their samples


# ---- Codes as text --------------------------------------------------------------------------------------------------

def header_scenes():
    yield "smallest", "no splats, one pixel", Scene(1, 1)
    yield "grey", "no splats, one channel", Scene(3, 2, layout=GREY)
    yield "background", "no splats, a background of its own", Scene(3, 2, background=(255, 0, 7))
    yield "background-alpha", "a background that is in part transparent", Scene(3, 2, layout=RGB_ALPHA, background=(90, 20, 0, 100))
    yield "background-clear", "alpha is 0 everywhere", Scene(2, 2, layout=GREY_ALPHA, background=(40, 0))
    yield "background-16", "16 bits, a background of its own", Scene(2, 2, high=1, background=(65535, 0, 12345))
    yield "layout-grey-alpha", "alpha in the layout, but not coded", Scene(2, 3, layout=GREY_ALPHA, alpha=0)
    yield "layout-rgb-grey", "RGB without chroma, and alpha that is not coded", Scene(2, 3, layout=RGB_ALPHA, alpha=0, chroma=0)
    for width, height in ((48, 48), (48, 32), (40, 30), (48, 27), (48, 30), (50, 40), (50, 25)):
        yield f"ratio-{width}x{height}", "a ratio with a symbol of its own", Scene(width, height)
        if width != height:
            yield f"ratio-{height}x{width}", "the same, portrait", Scene(height, width)
    yield "size-64x57", "the longer side is a multiple of 64", Scene(64, 57)
    yield "size-16384x1", "the longest side", Scene(16384, 1)
    yield "size-1x16383", "a long side that is no multiple of 64", Scene(1, 16383)
    yield "size-768x1", "the shorter side is rounded up to 1", Scene(768, 1)


def scalar_scenes():
    yield "one", "one splat", Scene(n=1).add(10, 4, 3, luma=14, co=5, cg=-3)
    yield "example", "the example of the page", Scene(12, 8, n=2).add(13, 6, 12, .3, .4, 6, 3, -1).add(8, 2, 1, .75, .6, 15, -2, 1)
    yield "photograph", "an ordinary photograph in colour", Scene(24, 16, n=20, texture=1).fill(1)
    yield "portrait", "a higher than wide picture", Scene(11, 19, n=12).fill(2)
    for blend, layout in itertools.product((NORMALIZED, ALPHA, SUM), range(4)):
        name = ("normalized", "alpha", "sum")[blend] + "-" + ("grey", "grey-alpha", "rgb", "rgb-alpha")[layout]
        scene = Scene(13, 11, n=8, blend=blend, layout=layout, opacity=(blend + layout) % 2)
        yield f"scalar-{name}", "scalar coding", scene.fill(10 + 4 * blend + layout)
    yield "isotropic", "no anisotropy", Scene(n=6, anisotropy=0).fill(30)
    yield "upright", "anisotropy without rotation", Scene(n=6, rotation=0).fill(31)
    yield "no-chroma", "RGB without chroma", Scene(n=6, chroma=0).fill(32)
    yield "plain-alpha", "alpha in the layout, but not coded", Scene(n=6, layout=RGB_ALPHA, alpha=0).fill(33)
    yield "bits-16", "16 bits a sample, alpha", Scene(8, 7, n=5, layout=RGB_ALPHA, high=1).fill(34)
    yield "waves", "waves on the colours of 16 bits", Scene(9, 8, n=6, texture=1, high=1).fill(35)
    yield "waves-alpha", "waves beside an alpha channel, which has none", Scene(20, 14, n=14, layout=RGB_ALPHA, texture=1).fill(38)
    waves = Scene(32, 32, n=16, texture=1, blend=SUM)
    for i in range(16):
        waves.add(7, i % 4, 0, (i % 4 + .5) / 4, (i // 4 + .5) / 4, amplitude=1 + i, wave=15 - i, direction=i, phase=i % 8)
    yield "waves-all", "every amplitude, wavelength, direction and phase", waves
    few = Scene(n=5, opacity=1, steps=DEFAULT_STEPS[:6] + (0,)).fill(36)
    yield "opacity-1", "one level of opacity", few
    yield "opacity-16", "sixteen levels of opacity", Scene(n=9, opacity=1, blend=ALPHA, steps=DEFAULT_STEPS[:6] + (15,)).fill(37)
    for i, step in enumerate(gscl.STEPS):
        for value in 0, 15:
            steps = [value if k == i else s for k, s in enumerate(DEFAULT_STEPS)]
            scene = Scene(14, 10, n=7, layout=RGB_ALPHA, opacity=1, blend=ALPHA, steps=steps)
            yield f"step-{step}-{value}", f"the step of {step} is {value}", scene.fill(40 + 2 * i + value % 2)
    yield "steps-low", "all steps 0, own background", Scene(n=6, texture=1, steps=(0,) * 7, background=(1, 2, 3)).fill(60)
    yield "steps-high", "all steps 15", Scene(n=6, texture=1, steps=(15,) * 7).fill(61)


def shape_scenes():
    scene = Scene(20, 20, n=11, steps=DEFAULT_STEPS)
    for i in range(11):
        scene.add(12 + i, min(2 * i, 12 + i), 0, (i + .5) / 11, .5, 2 * i)
    yield "aspects", "aspects 0 to 20 at the angle 0", scene
    scene = Scene(20, 20, n=6, steps=(2, 10, 4, 5, 3, 4, 3))
    for major, aspect, y in ((30, 22, .1), (30, 23, .3), (30, 24, .5), (30, 30, .7), (63, 62, .8), (63, 63, .9)):
        scene.add(major, aspect, 0, .5, y, aspect // 3)
    yield "aspect-escape", "aspects around 23, and the largest", scene
    scene = Scene(20, 20, n=8)
    C = scene.angle_count(8)
    for i, angle in enumerate((0, 1, C // 4, C // 4 + 1, C // 2, 3 * C // 4, 3 * C // 4 + 1, C - 1)):
        scene.add(12, 8, angle, (i % 4 + .5) / 4, (i // 4 + .5) / 2, 3 * i)
    yield "angles", f"flat and steep angles of {C}", scene
    scene = Scene(20, 20, n=5, steps=DEFAULT_STEPS)
    aspect = next(a for a in range(1, 40) if scene.angle_count(a) % 4 == 0)
    C = scene.angle_count(aspect)
    for i in range(5):
        scene.add(10 + i % 2, aspect, i * C // 4 % C, .1 + .2 * i, .2 + .15 * i, 5 * i)
    yield "angle-ties", f"aspect {aspect}, of {C} angles: exactly one and three quarters are flat", scene
    scene = Scene(20, 20, n=4, steps=(15, 0, 0, 5, 3, 4, 3))
    for i, angle in enumerate((0, 100, 256, 511)):
        scene.add(14, 14, angle, .2 + .2 * i, .5, 7 * i)
    yield "angles-512", "the most angles", scene
    scene = Scene(16, 16, n=4, steps=(15, 15, 4, 5, 3, 4, 3))
    for major, aspect in ((63, 0), (63, 63), (28, 28), (27, 27)):
        scene.add(major, aspect, 0, .5, .5, major // 3)
    yield "saturated", "axes and parts at their largest", scene
    scene = Scene(12, 12, n=8, steps=(0, 0, 4, 5, 3, 4, 3))
    for i in range(8):
        scene.add(i, i, 0, (i + .5) / 8, .5, 3 * i)
    yield "smallest-axes", "axes from half a pixel on, the smallest cells", scene
    scene = Scene(12, 12, n=6)
    for i in range(6):
        scene.add(22 + 3 * i, 6, 2, 1, 1, 4 * i)
    yield "outside", "centres in the last cell, some outside the image", scene
    L = 11
    colours = Scene(12, 12, n=12, blend=SUM, background=(128, 128, 128))
    for i, (luma, co, cg) in enumerate(((-22, -L, -L), (22, L, L), (-22, L, -L), (22, -L, L), (0, 0, 0), (20, 0, L)) * 2):
        colours.add(4 + i % 4, 0, 0, (i % 4 + .5) / 4, (i // 4 + .5) / 3, luma, co, cg)
    yield "colours-sum", "the ends of the ranges of colours, blend sum", colours
    colours = Scene(12, 12, n=12, layout=RGB_ALPHA)
    for i, (luma, co, cg, alpha) in enumerate(((-2, -L, -L, -2), (22, L, L, 18), (22, L, -L, 0), (-2, -L, L, 16)) * 3):
        colours.add(6 + i % 4, 0, 0, (i % 4 + .5) / 4, (i // 4 + .5) / 3, luma, co, cg, alpha)
    yield "colours-ends", "the ends of the ranges of colours and alpha", colours


def set_scenes():
    yield "one-cell-300", "300 equal splats, more than one split can count", Scene(8, 8, n=300).add(8, 0, 0, .5, .5, 20, count=300)
    scene = Scene(9, 9, n=700, blend=SUM, layout=GREY, background=(0,), steps=(6, 10, 4, 15, 4, 4, 3))
    for i in range(7):
        scene.add(4 + i, 0, 0, (i + .5) / 7, .5, i - 3, count=100)
    yield "seven-classes", "700 splats in seven cells of seven classes", scene
    scene = Scene(300, 200, n=30, layout=GREY, steps=(4, 0, 4, 5, 3, 4, 3))
    yield "wide", "grids of more than 128 cells, split by the splats before", scene.fill(70, (0, 30))
    scene = Scene(400, 8, n=4600, layout=GREY, anisotropy=0, steps=(6, 0, 4, 0, 4, 4, 3))
    scene.add(12, x=.3, count=2000).add(10, x=.31, count=2000).add(8, x=.6, count=500)
    for i in range(100):
        scene.add(4, x=.9 - .008 * i, y=.1 * (i % 7), luma=i % 4)
    yield "priors", "more splats than the 4096 that may be priors", scene
    yield "layers-2", "two layers", Scene(24, 16, n=20, layers=2).fill(71)
    yield "layers-8", "eight layers, with waves", Scene(24, 16, n=24, texture=1, layers=8).fill(72)
    far = Scene(400, 30, n=300, layout=GREY, anisotropy=0, steps=(6, 0, 4, 5, 3, 4, 3), layers=3)
    yield "layers-priors", "grids of more than 128 cells, split by the splats of the layers before, too", far.fill(73, (0, 20))
    scene = Scene(12, 12, n=4, blend=ALPHA, layers=4)
    for i in range(4):
        scene.add(9 + i, 2, 1, .2 + .2 * i, .5, 7 * i, layer=2 * (i % 2))
    yield "layers-empty", "the first and third of four layers have splats, those of the third are in front", scene
    scene = Scene(300, 20, n=640, layout=GREY, anisotropy=0, steps=DEFAULT_STEPS[:3] + (6, 4) + DEFAULT_STEPS[5:])
    yield "fine-steps", "the default steps of 640 splats", scene.fill(73)
    yield "all-sizes", "a splat of every class", all_sizes()
    yield "work-limit", "as much work as is allowed", work(320)
    yield "work-limit-needles", "likewise, of needles of which the shorter axis counts as 1/256 of the longer one", needle_work(1574)


def all_sizes():
    scene = Scene(32, 32, n=64, layout=GREY, steps=(2, 10, 4, 5, 3, 4, 3))
    for major in range(64):
        scene.add(major, 0, 0, major * 7 % 64 / 64, major * 11 % 64 / 64, major // 3)
    return scene


def work(splats):
    return Scene(1024, 1024, n=splats, anisotropy=0, layout=GREY).add(63, count=splats)


def needle_work(splats):
    return Scene(1024, 1024, n=splats, layout=GREY, steps=OCTAVES).add(44, 44, count=splats)


def bound_scenes():
    """Values that are bounded: the amplitude, the wave of a long axis, the ratio of the axes, the precision of a centre."""
    scene = Scene(24, 24, n=3, texture=1, steps=OCTAVES)
    for i in range(3):
        scene.add(51 + i, 0, 0, .5, .3 + .2 * i, 16, amplitude=8, wave=3 * i, direction=5 * i, phase=i)
    yield "bound-waves", "waves on axes of 2^12 pixels and less, and without effect on a longer one", scene
    scene = Scene(24, 24, n=5, texture=1, blend=SUM, steps=(4, 8, 4, 0, 4, 4, 3), background=(128, 128, 128))
    for i in range(5):
        scene.add(6, 0, 0, (i + .5) / 5, (i + .5) / 5, 0, amplitude=2 + 2 * i, wave=3, direction=3 * i, phase=i)
    yield "bound-amplitudes", "amplitudes of 1/3 to 1, of which the last two codes are above 1", scene
    scene = Scene(24, 24, n=4, blend=ALPHA, steps=OCTAVES)
    for i in range(4):
        code = 28 + 4 * i
        place = (5 * i + 3) * 256 / (scene.grid_step(code) * scene.cells(code, 24))  # pixel 5 i + 3
        scene.add(code, code, 256 * (i % 2), place, place, 7 * i)
    yield "bound-aspects", "axes with ratios of 128, 256, 512 and 1024", scene
    scene = Scene(12, 12, n=2, coding=gscl.CODEBOOK, blend=ALPHA).books(141, 2, 2, shape_bits=1, shape=(64, 512))
    scene.shape_words = [[1, 0, 0], [0, 1, 0]]
    scene.splats[:] = []
    yield "bound-axes", "words of which one axis is 2^14 times as long as the other", scene.add_indexed(0, 0, 7, 9).add_indexed(1, 1, 20, 21)
    scene = Scene(12, 12, n=12, coding=gscl.CODEBOOK, blend=ALPHA, background=(0, 0, 0)).books(142, 1, 1, 16, shape=(0, 0))
    scene.colour_words = [[31] * len(scene.colour_words[0])]
    scene.splats[:] = []
    for i in range(12):
        scene.add_indexed(0, 0, int(((i + .5) * 512 + 32.9) * 65536 / 12 / 512), int((i + .5) / 12 * 65536))
    yield "bound-centres", "axes of 1/16 pixel, at centres that are no multiples of 1/512 pixel but for rounding", scene


def codebook_scenes():
    book = lambda n=8, **options: Scene(n=n, coding=gscl.CODEBOOK, **{"blend": ALPHA, **options})
    for blend, layout in itertools.product((NORMALIZED, ALPHA, SUM), range(4)):
        name = ("normalized", "alpha", "sum")[blend] + "-" + ("grey", "grey-alpha", "rgb", "rgb-alpha")[layout]
        scene = book(width=13, height=11, blend=blend, layout=layout, opacity=(blend + layout + 1) % 2)
        yield f"codebook-{name}", "codebook coding", scene.books(100 + 4 * blend + layout)
    yield "codebook-empty", "no splats, so that there are no codebooks", book(0)
    yield "codebook-one", "one word in each codebook, one splat", book(1).books(120, 1, 1)
    yield "codebook-isotropic", "no anisotropy", book(anisotropy=0).books(121)
    yield "codebook-upright", "anisotropy without rotation", book(rotation=0).books(122)
    yield "codebook-no-chroma", "RGB without chroma", book(chroma=0).books(123)
    yield "codebook-16", "16 bits a sample", book(layout=RGB_ALPHA, high=1, width=7, height=8).books(124)
    yield "codebook-bits-1", "codes and positions of one bit", book(30).books(125, 5, 3, 1, 1, 1)
    yield "codebook-bits-16", "codes and positions of 16 bits", book(12).books(126, 4, 4, 16, 16, 16)
    yield "codebook-ranges", "the ends of all ranges", book(opacity=1).books(127, shape=(0, 640), colour=(-255, 510))
    yield "codebook-flat-ranges", "ranges of one value", book().books(128, shape=(160, 160), colour=(77, 77))
    yield "codebook-words", "40 shapes, some in use, and 60 colours", book(30).books(129, 40, 60, 5, 2, 2)
    scene = book(300).books(130, 1, 2, 8)
    scene.splats[:] = []
    yield "codebook-one-cell", "300 splats in one cell", scene.add_indexed(0, 0, 77, 99, 150).add_indexed(0, 1, 77, 99, 150)


def block_scenes():
    one = lambda *blocks: Scene(5, 4, n=1, layout=GREY, blocks=blocks).add(8, 2, 1, luma=15)
    space, icc, exif, xmp = (0, b"\x01\x0d"), (1, b"profile" * 30), (32, b"II*\0"), (33, b"<x/>")
    yield "block-space", "a colour space", one(space)
    yield "block-icc", "an ICC profile of 210 bytes", one(icc)
    yield "block-exif", "EXIF after the picture", one(exif)
    yield "block-xmp", "XMP after the picture", one(xmp)
    yield "blocks", "all blocks", one(space, icc, exif, xmp)
    yield "blocks-empty", "blocks without content", one((1, b""), (33, b""))


# ---- Files that no writer makes -------------------------------------------------------------------------------------

class Forger(gscl.RangeDecoder):
    """Takes the place of the range decoder: a function chooses each symbol, and the symbols become a picture."""

    def __init__(self, choose):
        self.choose, self.picture, self.symbols = choose, gscl_file.Picture(), 0

    def decode(self, f, total=None):
        s = self.choose(self.symbols, len(f))
        self.symbols += 1
        self.picture.symbol(s, f)
        return s

    def uniform(self, n):
        return self.decode((1,) * n) if n > 1 else 0

    def bytes_read(self):
        return 0


def forge(script, rules=()):
    """A picture of the symbols that `script` has, by their numbers, or else `rules`, by the sizes of their alphabets; the
    others are 0."""
    script, rules = dict(script), dict(rules)
    forger = Forger(lambda number, count: script.get(number, rules.get(count, 0)))
    picture = gscl.Picture()
    picture.read_header(forger)
    picture.read_splats(forger, 0)
    return forger.picture.finish()


# The symbols of the header of an ordinary photograph of 9 x 9 pixels: kind, has_texture, no multiple of 64, longer side
# (length in bits, remaining bits), ratio, number of splats (1), layers, steps, background.
SQUARE = {0: 0, 1: 0, 2: 0, 3: 4, 4: 0, 5: 1, 6: 1, 7: 0, 8: 0, 9: 0}
# Of codebook coding: kind, blend, coding, layout (grey), depth, opacity, anisotropy, rotation, then size and background (13).
BOOK = {0: 1, 1: 1, 2: 1, 3: 0, 4: 0, 5: 0, 6: 1, 7: 1, 8: 0, 9: 4, 10: 0, 11: 1, 12: 1, 13: 0}


def forged_pictures():
    """(name, what it is, picture)"""
    yield "long-square", "a square by the ratio `free`", forge({**SQUARE, 5: 0, 6: 8, 7: 1})
    yield "long-side", "64 pixels that are not coded as a multiple of 64", forge({**SQUARE, 3: 6, 4: 31})
    yield "long-steps", "explicit steps that are the default", \
        forge({**SQUARE, 8: 1, **{9 + i: step for i, step in enumerate((6, 8, 4, 5, 3))}})
    yield "long-pivot-low", "a pivot below 0, which counts as 0", forge({**SQUARE, 9: 7, 10: 63})
    yield "long-pivot-high", "a pivot of more than 63, which counts as 63", forge({**SQUARE, 9: 7, 10: 62})
    yield "long-range-axis", "an axis of a codebook of 641, which counts as 640", forge({**BOOK, 19: 10, 21: 8, 22: 1})
    yield "long-range-min", "a range of a codebook of which both ends are too high", forge({**BOOK, 19: 16, 20: 1, 21: 16})
    yield "long-range-angle", "an angle of a codebook of 257, which counts as 256", forge({**BOOK, 23: 9, 24: 1})
    yield "long-range-colour", "a colour of a codebook of 511, which counts as 510", forge({**BOOK, 26: 10, 27: 254})


def container_files(picture):
    """(name, what it is, bytes)"""
    make, file = gscl_file.contained, gscl_file.contained(picture)
    block = lambda head, content: bytes([head, len(content)]) + content
    yield "block-unknown-before", "an unknown block before the picture", make(picture, before=block(0x85, b"abc"))
    yield "block-unknown-after", "an unknown block after the picture", make(picture, after=block(0x20, b"II*\0") + block(0xBF, b"abc"))
    yield "block-known-mandatory", "known blocks that are mandatory", \
        make(picture, before=block(0x40, b"\1\15") + block(0xC1, b"profile"), after=block(0xE1, b"<x/>"))
    yield "empty", "no bytes", b""
    yield "magic-3", "three bytes", file[:3]
    yield "magic-other", "another magic", b"\x89" + file[1:]
    yield "magic-text", "the magic as text", b"gscl" + file[4:]
    yield "version-0", "version 0", make(picture, version=0)
    yield "version-1", "version 1", make(picture, version=1)
    yield "version-3", "version 3", make(picture, version=3)
    yield "version-15", "version 15, cut after the version", make(picture, version=15)[:5]
    yield "cut-magic", "only the magic", file[:4]
    yield "cut-6", "six bytes", file[:6]
    yield "cut-header", "no byte of the picture", file[:7]
    yield "cut-half", "half a file", file[:len(file) // 2]
    with_blocks = make(picture, before=block(0x00, b"\1\15") + block(0x81, b"p" * 30), after=block(0xA0, b"II*\0"))
    yield "cut-block", "cut in a block before the picture", with_blocks[:20]
    yield "cut-block-size", "cut before the size of a block", with_blocks[:8]
    yield "damaged-reserved", "a reserved bit, and half a file", make(picture, version=0x42)[:len(file) // 2]
    yield "damaged-order", "types that do not increase, and half a file", \
        make(picture, before=block(0x01, b"p") + block(0x81, b"p"))[:len(file) // 2]
    yield "damaged-mandatory", "an unknown mandatory block, and half a file", \
        make(picture, before=block(0xC2, b"abc"))[:len(file) // 2]
    yield "damaged-bit", "one bit of the picture flipped", file[:12] + bytes([file[12] ^ 1]) + file[13:]
    yield "damaged-check", "another check", file[:-1] + bytes([file[-1] ^ 128])
    yield "damaged-blocks", "one bit of a block flipped", with_blocks[:15] + bytes([with_blocks[15] ^ 2]) + with_blocks[16:]
    yield "reserved-6", "a reserved bit", make(picture, version=0x42)
    yield "reserved-7", "a reserved bit", make(picture, version=0x82)
    yield "reserved-mandatory", "a reserved bit and an unknown mandatory block", make(picture, before=block(0xC2, b"abc"), version=0x42)
    yield "picture-long", "one byte after the picture", make(picture + b"\0")
    yield "picture-short", "one byte less of the picture, with a check that matches", make(picture[:-1])
    yield "picture-none", "no picture, with a check that matches", make(b"")
    yield "block-order", "types that do not increase", make(picture, before=block(0x01, b"p") + block(0x80, b"\1\15"))
    yield "block-twice", "a type twice", make(picture, before=block(0x01, b"p") + block(0x81, b"p"))
    yield "block-before", "type 32 before the picture", make(picture, before=block(0xA0, b"II*\0"))
    yield "block-after", "type 31 after the picture", make(picture, after=block(0x9F, b"p"))
    yield "block-mandatory-before", "an unknown mandatory block before the picture", make(picture, before=block(0xC2, b"abc"))
    yield "block-mandatory-after", "an unknown mandatory block after the picture", make(picture, after=block(0xE2, b"abc"))
    yield "block-mandatory-order", "types that do not increase, then an unknown mandatory block", \
        make(picture, before=block(0x01, b"p") + block(0x01, b"p") + block(0xC2, b"abc"))
    yield "block-mandatory-picture", "a picture that is too long, then an unknown mandatory block", \
        make(picture + b"\0", after=block(0xE2, b"abc"))
    yield "block-mandatory-both", "types that do not increase before, an unknown mandatory block after the picture", \
        make(picture, before=block(0x01, b"p") + block(0x81, b"p"), after=block(0xE2, b"abc"))
    yield "block-mandatory-first", "an unknown mandatory block before, a type that is not allowed after the picture", \
        make(picture, before=block(0xC2, b"abc"), after=block(0x9F, b"p"))
    yield "block-mandatory-beyond", "an unknown mandatory block that is longer than the file, with a check that matches", \
        make(b"", before=b"\xC2\x7Fabc")
    yield "block-space-3", "a colour space of three bytes", make(picture, before=block(0x80, b"\1\15\0"))
    yield "block-size-long", "a size with a byte too many", make(picture, before=b"\x81\x83\0abc")
    yield "block-size-4", "a size of four bytes", make(picture, before=b"\x81\x83\x80\x80\1" + b"a" * 4)
    yield "block-size-beyond", "a block that is longer than the file, with a check that matches", make(b"", before=b"\x81\x7Fabc")
    yield "block-not-last", "a list after the picture without a last block", make(picture, after=block(0x21, b"<x/>"))
    yield "list-none", "an empty list after the picture", sealed(file[:-2] + bytes(3), 0)
    yield "list-gap", "a byte before the list after the picture that is not 0", sealed(file[:-2] + b"\0\1\0\xA1\0", 2)
    yield "list-gap-mandatory", "the same, and an unknown mandatory block in the list", sealed(file[:-2] + b"\0\1\0\xE2\0", 2)
    yield "list-long", "a list after the picture that is longer than the file", sealed(file[:-2] + bytes(3) + b"\xA1\0", 1 << 31)
    yield "list-rest", "a byte between the list after the picture and its size", sealed(file[:-2] + bytes(3) + b"\xA1\0\0", 3)
    yield "list-no-size", "no room for the size of the list after the picture", sealed(b"\xC7gsc\2", None)
    yield "list-no-gap", "no room for the bytes before the list after the picture", sealed(b"\xC7gsc\2\0\xA1\0", 2)


def sealed(data, size):
    """Sets bit 5, adds the size of the list after the picture and the check."""
    data = data[:4] + bytes([data[4] | 32]) + data[5:] + (b"" if size is None else size.to_bytes(4, "little"))
    return data + gscl_file.crc16(data).to_bytes(2, "big")


# ---- The set --------------------------------------------------------------------------------------------------------

class Writer:
    """Writes into folders in `out`."""

    def __init__(self, codes, out):
        self.codes, self.out, self.index = codes, out, []
        for folder in "files", "pictures":
            os.makedirs(out / folder, exist_ok=True)
            for old in (out / folder).iterdir():
                old.unlink()

    def library(self, scene, *options, form="write"):
        """The bytes that the library writes for these codes."""
        with tempfile.TemporaryDirectory() as folder:
            text, out = pathlib.Path(folder, "codes.txt"), pathlib.Path(folder, "out.gscl")
            text.write_text(scene.codes())
            self.codes.run(form, text, out, *options)
            return out.read_bytes()

    def packets(self, scene, identity=1, count=1, repairs=0, *options):
        """The packets that the library writes for these codes, then repair packets."""
        return gscl.packets_of(self.library(scene, identity, count, repairs, *options, form="packets"))

    def add(self, name, about, data, bare=False, packets=False):
        """Adds a file, or a list of packets, with what the decoder says of it."""
        (self.out / "files" / (name + (".gsclp" if packets else ".gscl"))).write_bytes(data)
        entry = {"file": name, "about": about, "bare": bare, **({"packets": True} if packets else {}), "result": "valid"}
        if packets and gscl.is_repaired(data):
            entry["repaired"] = True
        try:
            picture = gscl.decode(data, bare)
            entry["codes"] = picture.codes_hash()
            self.add_picture(name, entry, picture)
        except gscl.Refused as error:
            entry["result"] = error.result.replace(" ", "-")
        self.index.append(entry)
        return entry

    def add_picture(self, name, entry, picture):
        if picture.width * picture.height <= MAX_DRAWN and picture.n <= 1000:
            entry["picture"] = f"{name}.png"
            (self.out / "pictures" / entry["picture"]).write_bytes(gscl.png_bytes(picture))
            return
        pick = random.Random(1)
        places = [(pick.randrange(picture.width), pick.randrange(picture.height)) for _ in range(12)]
        entry["samples"] = [[x, y, *picture.integers((x, y, 1, 1))[0][0]] for x, y in places]


def scenes():
    return itertools.chain(header_scenes(), scalar_scenes(), shape_scenes(), set_scenes(), bound_scenes(), codebook_scenes(), block_scenes())


def expect(entry, *results):
    if entry["result"] not in results:
        raise ValueError(f'{entry["file"]}: the result is {entry["result"]}')


def make(writer):
    for name, about, scene in scenes():
        expect(writer.add(name, about, writer.library(scene)), "valid")
    photograph = Scene(24, 16, n=20, texture=1).fill(1)
    bare = writer.library(photograph, "bare")
    book = writer.library(Scene(n=8, coding=gscl.CODEBOOK, blend=ALPHA).books(140), "bare")
    for name, about, data in (("bare-photograph", "a bare file", bare), ("bare-codebook", "a bare file of codebook coding", book),
                              ("bare-smallest", "a bare file without splats", writer.library(Scene(1, 1), "bare"))):
        expect(writer.add(name, about, data, True), "valid")
    for name, about, data in (("bare-empty", "no bytes", b""), ("bare-cut", "half a bare file", bare[:len(bare) // 2]),
                              ("bare-cut-1", "the last byte is missing", bare[:-1])):
        expect(writer.add(name, about, data, True), "truncated")
    expect(writer.add("bare-long", "a byte too many", bare + b"\0", True), "corrupt")
    for name, about, picture in forged_pictures():
        expect(writer.add(name, about, gscl_file.contained(picture)), "valid")
    too_much = gscl_file.contained(writer.library(work(321), "unchecked"))
    expect(writer.add("bad-work", "more work than is allowed", too_much), "corrupt")
    expect(writer.add("cut-work", "the same without its last half", too_much[:len(too_much) // 2]), "truncated")
    too_much = gscl_file.contained(writer.library(needle_work(1575), "unchecked"))
    expect(writer.add("bad-work-needles", "the same of needles", too_much), "corrupt")
    for name, about, data in container_files(bare):
        writer.add(name, about, data)
    for name, about, data, result in packet_lists(writer.packets):
        expect(writer.add(name, about, data, packets=True), result)


def main():
    writer = Writer(Codes(os.path.abspath(sys.argv[1])), HERE)
    make(writer)
    lines = ",\n".join(json.dumps(entry) for entry in writer.index)
    (HERE / "index.json").write_text(f"[\n{lines}\n]\n")


if __name__ == "__main__":
    main()
