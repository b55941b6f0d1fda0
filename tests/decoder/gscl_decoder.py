#!/usr/bin/env python3
"""A second decoder of gscl files, written from format/FORMAT.md alone, with nothing but Python's own library.

    gscl_decoder.py [--bare] FILE            says what the file holds
    gscl_decoder.py [--bare] FILE OUT.png    draws the picture in double precision
    gscl_decoder.py [--bare] --codes FILE    prints the decoded codes as text (see Picture.codes)
    gscl_decoder.py [--bare] --hash FILE     prints the SHA-256 of that text
    gscl_decoder.py [--bare] --partial FILE [OUT.png]    as much as a prefix of a file shows

FILE may also be a list of packets, or one packet, whose bytes do not begin as those of a file do.  Packets that a list lacks are
computed from its repair packets, where it has enough of them.

An invalid file ends the program with status 1 and the result of the page's section "Errors" on the standard error stream.
The names of functions and variables are those of the page; the trained tables are read from the page itself.  The program is
simple rather than fast: one million pixels and some hundred splats take about a minute.
"""
import argparse
import hashlib
import math
import os
import re
import struct
import sys
import zlib

PAGE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "format", "FORMAT.md")

NOT_GSCL = "not a gscl file"
NEWER = "newer version"
TRUNCATED = "truncated"
DAMAGED = "damaged"
UNKNOWN_BLOCK = "unknown block"
CORRUPT = "corrupt"

NORMALIZED, ALPHA, SUM = range(3)
SCALAR, CODEBOOK = range(2)
GREY, GREY_ALPHA, RGB, RGB_ALPHA = range(4)


class Refused(Exception):
    """A file that a reader must refuse.  `result` is a result of the section "Errors"."""

    def __init__(self, result, reason):
        super().__init__(f"{result}: {reason}")
        self.result = result


class NotAllowed(Exception):
    """A value that the page does not allow."""


class BeyondEnd(Exception):
    """A block or a picture needs bytes beyond the end."""


# ---------------------------------------------------------------------------------------------- the page's tables

def read_tables(path=PAGE):
    """The tables of the section "Trained tables": rows are separated by `|` and by line feeds, tables by comments."""
    with open(path, encoding="utf-8") as page:
        section = re.search(r"^## Trained tables\n(.*?)^## ", page.read(), re.M | re.S).group(1)
    parts = re.findall(r"(?:^ {4}[\d |]+\n)+", section, re.M)
    aspect, direction, textured, waves, classes = (
        [[int(word) for word in row.split()] for row in re.split(r"[|\n]", part.strip("\n"))] for part in parts)
    shapes = [(len(table), {len(row) for row in table}) for table in (aspect, direction, textured, waves, classes)]
    if shapes != [(24, {24}), (8, {16}), (12, {2}), (2, {16}), (40, {2})]:
        raise ValueError(f"{path}: the trained tables have the shapes {shapes}")
    return {"aspect": aspect, "direction": direction, "textured": textured, "amplitude": waves[:1], "wave": waves[1:],
            "class": classes}


TABLES = read_tables()

# T[i] = 2^(i/32) * 2^24, rounded: as printed in the section "Dequantisation", which test_decoder.py compares.
T = [round(2 ** (i / 32) * 2 ** 24) for i in range(33)]

LEVELS = [4, 6, 8, 11, 16, 20, 24, 28, 32, 40, 48, 64, 96, 128, 192, 255]


def quotient(a, b):
    """a / b of the page: rounded towards zero."""
    return abs(a) // abs(b) * (1 if (a < 0) == (b < 0) else -1)


def ceil_quotient(a, b):
    return -(-a // b)


def clamp(value, lowest, highest):
    return min(max(value, lowest), highest)


# ---------------------------------------------------------------------------------------------- the range coder

class RangeDecoder:
    """Decodes symbols of data[start:end]; raises BeyondEnd when more than `beyond` bytes after the end are read."""

    def __init__(self, data, start, end, beyond=3):
        self.data, self.start, self.end, self.beyond = data, start, end, beyond
        self.position = start
        self.range = 0xFFFFFFFF
        self.code = 0
        for _ in range(4):
            self.code = self.code << 8 | self.next_byte()

    def next_byte(self):
        byte = self.data[self.position] if self.position < self.end else 0
        self.position += 1
        if self.position > self.end + self.beyond:
            raise BeyondEnd("the picture needs bytes beyond its end")
        return byte

    def bytes_read(self):
        return self.position - self.start

    def decode(self, f, total=None):
        total = sum(f) if total is None else total
        unit = self.range // total
        target = min(self.code // unit, total - 1)
        cum = s = 0
        while target >= cum + f[s]:
            cum += f[s]
            s += 1
        self.take(cum, f[s], total, unit)
        return s

    def uniform(self, n):
        unit = self.range // n
        s = min(self.code // unit, n - 1)
        self.take(s, 1, n, unit)
        return s

    def take(self, cum, frequency, total, unit):
        self.code -= cum * unit
        self.range = self.range - cum * unit if cum + frequency == total else frequency * unit
        while self.range < 1 << 24:
            self.range <<= 8
            self.code = (self.code << 8 | self.next_byte()) & 0xFFFFFFFF

    def raw(self, bits):
        return self.uniform(1 << bits)

    def flag(self, n):
        return self.decode([16 - n, n])

    def number(self, f):
        b = self.decode(f)
        if b <= 1:
            return b
        if b <= 17:
            return (1 << (b - 1)) + self.raw(b - 1)
        high = self.raw(b - 17)
        return (1 << (b - 1)) + high * 65536 + self.raw(16)


# ---------------------------------------------------------------------------------------------- models

class Model:
    """An adaptive model with the frequencies f."""

    def __init__(self, f, gains, mean_limit):
        self.f = f
        self.gains = gains
        self.limit = min(len(f) * mean_limit, 32000)

    def add(self, i, amount):
        if 0 <= i < len(self.f):
            self.f[i] += amount

    def update(self, v):
        self.add(v, self.gains[0])
        for d in 1, 2:
            self.add(v - d, self.gains[d])
            self.add(v + d, self.gains[d])
        while sum(self.f) > self.limit:
            self.f[:] = [(n + 1) // 2 for n in self.f]

    def decode(self, coder):
        v = coder.decode(self.f)
        self.update(v)
        return v


class ConditionalModel:
    def __init__(self, table, gains, cyclic=False):
        self.f = [[4 * n for n in row] for row in table]
        self.gains = gains
        self.cyclic = cyclic

    def update(self, r, v):
        symbols = len(self.f[0])
        for q in range(max(r - 3, 0), min(r + 3, len(self.f) - 1) + 1):
            weight = 4 - abs(q - r)
            row = self.f[q]
            row[v] += weight * self.gains[0]
            for d in 1, 2:
                for neighbour in v - d, v + d:
                    if self.cyclic:
                        neighbour %= symbols
                    if 0 <= neighbour < symbols:
                        row[neighbour] += weight * self.gains[d]
            if sum(row) > 4000:
                row[:] = [(n + 1) // 2 for n in row]

    def decode(self, coder, r, symbols=None):
        v = coder.decode(self.f[r][:symbols])
        self.update(r, v)
        return v


# ---------------------------------------------------------------------------------------------- the picture

RATIOS = [None, (1, 1), (3, 2), (4, 3), (16, 9), (16, 10), (5, 4), (2, 1)]
STEPS = "scale position angle luma chroma alpha opacity".split()
FLAGS = "has_chroma has_alpha has_opacity has_anisotropy has_rotation has_texture".split()


class Splat:
    """Codes of one splat: those of the page, as attributes."""

    def scalar_codes(self):
        """All codes of scalar coding, in the order of those of one cell."""
        return (self.aspect, self.angle, self.part, self.luma, self.co, self.cg, self.alpha, self.opacity, self.amplitude, self.wave,
                self.direction, self.phase)


class Grid:
    """The cells of a class: their numbers and pitches in x and y."""

    def __init__(self, cells_x, cells_y, pitch_x, pitch_y):
        self.size, self.pitch = [cells_x, cells_y], [pitch_x, pitch_y]

    def cell_of_class(self, cell):
        return cell


class PacketGrid(Grid):
    """The cells of a class of scalar coding that a packet may have: all of them in a picture that is no packet."""

    def __init__(self, picture, major):
        step = picture.grid_step(major)
        super().__init__(picture.cells(major, picture.width), picture.cells(major, picture.height), step, step)
        self.cells, self.K, self.k = max(self.size), picture.K, picture.k
        self.is_part = self.K > 1 and self.cells >= 2 * self.K
        self.along = 0 if self.size[0] >= self.size[1] else 1
        self.skew = next(n for n in range(self.K + 1) if n * (n + 1) >= self.K)
        if self.is_part:
            self.size[self.along] = ceil_quotient(self.cells, self.K)
            self.pitch[self.along] *= self.K

    def cell_of_class(self, cell):
        if not self.is_part:
            return cell
        a, b = cell[self.along], cell[1 - self.along]
        along = min(self.K * a + (self.k + self.skew * b) % self.K, self.cells - 1)
        return (along, b) if self.along == 0 else (b, along)


class Picture:
    """Header and splats.  `certain` is the number of splats decoded from bytes that had come.

    K and k are those of a packet; a picture that is no packet is read like the only one."""

    def __init__(self, in_packet=False):
        self.in_packet = in_packet
        self.K, self.k = 1, 0
        self.n = 0
        self.splats = []
        self.blocks = []
        self.certain = 0

    # ------------------------------------------------------------------------------------------ header

    def read_header(self, coder):
        self.read_header_to_n(coder)
        may_have_layers = self.coding == SCALAR and self.n > 0 and not self.in_packet
        self.layers = 2 + coder.uniform(7) if may_have_layers and coder.flag(1) else 1
        self.step, self.pivot = dict.fromkeys(STEPS, 0), 0
        if self.coding == SCALAR and self.n > 0:
            self.read_steps(coder)
        self.channels = (3 if self.has_chroma else 1) + self.has_alpha
        own = 1 if self.n == 0 else coder.flag(2)
        self.background = [coder.raw(16 if self.high_bit_depth else 8) for _ in range(self.channels)] if own else None
        self.levels = {name: LEVELS[self.step[name]] for name in ("luma", "chroma", "alpha")}

    def read_header_to_n(self, coder):
        if self.in_packet:
            self.K = 1 + coder.number([8, 2, 3, 4, 4, 3, 2, 1, 1])
            self.k = coder.uniform(self.K)
        self.read_kind(coder)
        self.read_size(coder)
        self.n = min(coder.number([2, 1, 1, 2, 4, 6, 8, 7, 7, 6, 5, 4, 2, 1, 1, 1, 1, 1, 1, 1, 1, 1]), 1048576)

    def read_kind(self, coder):
        if coder.flag(4) == 0:
            self.blend, self.coding, self.layout, self.high_bit_depth = NORMALIZED, SCALAR, RGB, 0
            self.has_chroma, self.has_alpha, self.has_opacity, self.has_anisotropy, self.has_rotation = 1, 0, 0, 1, 1
        else:
            self.blend = coder.decode([10, 4, 2])
            self.coding = SCALAR if self.in_packet else coder.flag(3)
            self.layout = coder.decode([5, 2, 4, 5])
            self.high_bit_depth = coder.flag(4)
            self.has_chroma = coder.flag(12) if self.layout in (RGB, RGB_ALPHA) else 0
            self.has_alpha = coder.flag(14) if self.layout in (GREY_ALPHA, RGB_ALPHA) else 0
            self.has_opacity = coder.flag(6)
            self.has_anisotropy = coder.flag(14)
            self.has_rotation = coder.flag(14) if self.has_anisotropy else 0
        self.has_texture = coder.flag(12) if self.coding == SCALAR else 0

    def read_size(self, coder):
        if coder.flag(8):
            longer = 64 * (1 + coder.number([1, 1, 3, 7, 9, 6, 3, 1, 1]))
        else:
            longer = 1 + coder.number([1, 1, 1, 1, 2, 2, 3, 4, 6, 10, 14, 10, 6, 2, 1])
        ratio = RATIOS[coder.decode([10, 3, 8, 6, 2, 1, 1, 1])]
        if ratio is None:
            shorter = 1 + coder.uniform(longer)
        else:
            a, b = ratio
            shorter = max(1, (2 * longer * b + a) // (2 * a))
        portrait = coder.flag(6) if shorter < longer else 0
        self.width, self.height = (shorter, longer) if portrait else (longer, shorter)

    def read_steps(self, coder):
        used = {"angle": self.has_rotation, "chroma": self.has_chroma, "alpha": self.has_alpha, "opacity": self.has_opacity}
        fine = 1 if self.n * self.K >= 640 else 0
        default = dict(zip(STEPS, (6, 8, 4, 5 + fine, 3 + fine, 4, 3)))
        explicit = coder.flag(2)
        for name in STEPS:
            if used.get(name, 1):
                self.step[name] = coder.raw(4) if explicit else default[name]
        d = coder.number([8, 4, 4, 2, 1, 1, 1, 1])
        self.pivot = clamp(self.typical() + (-(d + 1) // 2 if d % 2 else d // 2), 0, 63)

    # ------------------------------------------------------------------------------------------ dequantisation of integers

    def sigma(self, code):
        e = code * (self.step["scale"] + 4)
        return 1 << 31 if e >= 512 else (T[e % 32] << (e // 32)) >> 9

    def grid_step(self, major):
        return max(8, (self.sigma(major) * (self.step["position"] + 2)) >> 13)

    def cells(self, major, dimension):
        return ceil_quotient(dimension * 256, self.grid_step(major))

    def parts(self, aspect):
        e = aspect * (self.step["scale"] + 4)
        return 65536 if e >= 512 else ((T[e % 32] << (e // 32)) + (1 << 23)) >> 24

    def typical(self):
        for c in range(63):
            if (self.sigma(c) >> 8) ** 2 * self.n * self.K >= self.width * self.height << 16:
                return c
        return 63

    def angle_count(self, aspect):
        e = aspect * (self.step["scale"] + 4)
        if e >= 256:
            return 512
        a = T[e % 32] << (e // 32)
        inverse = T[32 - e % 32] >> (e // 32 + 1)
        return clamp(ceil_quotient((a - inverse) * 52707179, (self.step["angle"] + 2) << 44), 1, 512)

    # ------------------------------------------------------------------------------------------ splats

    def read_splats(self, coder, come):
        """come: the number of bytes of the picture that have come, for `certain`."""
        if self.n == 0:
            return
        if self.coding == CODEBOOK:
            self.read_codebooks(coder)
            counts = self.codebook_class_counts(coder)
            self.start_codebook_splats()
        else:
            counts = self.scalar_class_counts(coder)
            self.start_scalar_splats()
        self.read_classes(coder, counts, come)

    def read_classes(self, coder, counts, come):
        """Appends to `splats` one by one, so that a decoder of a prefix has those before the end."""
        earlier = []
        for number, count in enumerate(counts):
            if self.coding == SCALAR:
                layer, major = number // 64, 63 - number % 64
                grid = PacketGrid(self, major)
            else:
                grid = Grid(1 << self.position_bits, 1 << self.position_bits, self.width, self.height)
            cells = []
            if count:
                points(coder, cells, grid.pitch, (0, 0, *grid.size), count, collect_priors(earlier))
            earlier.append([((2 * x + 1) * grid.pitch[0], (2 * y + 1) * grid.pitch[1]) for x, y in cells])
            for x, y in map(grid.cell_of_class, cells):
                splat = self.read_scalar_splat(coder, layer, major, x, y) if self.coding == SCALAR else \
                    self.read_codebook_splat(coder, number, x, y)
                self.splats.append(splat)
                if coder.bytes_read() <= come:
                    self.certain = len(self.splats)

    def scalar_class_counts(self, coder):
        """Yields the counts of all classes.  Those of a layer are read before the first of them is returned."""
        rest = self.n
        typical = self.typical()
        for layer in range(self.layers):
            left = rest if rest == 0 or layer == self.layers - 1 else split(coder, rest, 64, 64)
            rest -= left
            counts = []
            for major in range(63, -1, -1):
                r = clamp(major - typical + 12, 0, 39)
                counts.append(left if left == 0 or major == 0 else split(coder, left, *TABLES["class"][r]))
                left -= counts[-1]
            yield from counts

    def codebook_class_counts(self, coder):
        classes = len(self.shape_words)
        result = [0] * classes
        first = coder.uniform(classes)
        last = first + coder.uniform(classes - first)

        def counts(first, c, n):
            if c == 1:
                result[first] = n
                return
            if n == 0:
                return
            left = split(coder, n, c // 2 * 128, (c - c // 2) * 128)
            counts(first, c // 2, left)
            counts(first + c // 2, c - c // 2, n - left)

        counts(first, last - first + 1, self.n)
        return result

    # ------------------------------------------------------------------------------------------ codebook coding

    def read_codebooks(self, coder):
        self.position_bits = coder.raw(4) + 1
        self.shape_bits = coder.raw(4) + 1
        self.colour_bits = coder.raw(4) + 1
        shape_count = coder.raw(10) + 1
        colour_count = coder.raw(10) + 1
        shape = [(0, 640)] + [(0, 640)] * self.has_anisotropy + [(0, 256)] * self.has_rotation
        colour = [(-255, 510)] * self.channels + [(0, 255)] * self.has_opacity
        self.shape_ranges = [self.read_range(coder, *limits) for limits in shape]
        self.colour_ranges = [self.read_range(coder, *limits) for limits in colour]
        self.shape_words = self.read_words(coder, shape_count, len(shape), self.shape_bits, True)
        self.colour_words = self.read_words(coder, colour_count, len(colour), self.colour_bits, False)

    @staticmethod
    def read_range(coder, lowest, highest):
        def number():
            b = coder.uniform(17)
            return b if b <= 1 else (1 << (b - 1)) + coder.raw(b - 1)
        minimum = min(lowest + number(), highest)
        return minimum, min(minimum + number(), highest)

    @staticmethod
    def read_words(coder, count, dimensions, bits, descending):
        cells = []
        points(coder, cells, (1, 1), (0, 0, 1 << bits, 1), count, [])
        first = sorted((x for x, _ in cells), reverse=descending)
        return [[value] + [coder.raw(bits) for _ in range(dimensions - 1)] for value in first]

    def start_codebook_splats(self):
        self.colour_model = Model([16] * len(self.colour_words), (32, 4, 0), 256)

    def read_codebook_splat(self, coder, number, x, y):
        splat = Splat()
        splat.shape, splat.x, splat.y = number, x, y
        splat.colour = self.colour_model.decode(coder)
        return splat

    # ------------------------------------------------------------------------------------------ scalar coding

    def fineness(self, major, aspect):
        area = (2 * major - aspect - 2 * self.pivot) * (self.step["scale"] + 4)
        return 1 + sum(area >= least for least in (-210, -92, -15, 43, 90, 128, 161))

    def limits(self, name):
        """Lowest and highest level of luma, or code of alpha."""
        L = self.levels[name]
        return (-L - L // 8 if self.blend == SUM else -(L // 8)), L + L // 8

    def start_scalar_splats(self):
        self.size_origin = self.typical()
        self.aspect_model = ConditionalModel(TABLES["aspect"], (4, 2, 1))
        self.direction_model = ConditionalModel(TABLES["direction"], (7, 1, 0), cyclic=True)
        self.textured_model = ConditionalModel(TABLES["textured"], (10, 0, 0))
        self.amplitude_model = ConditionalModel(TABLES["amplitude"], (5, 2, 1))
        self.wave_model = ConditionalModel(TABLES["wave"], (5, 2, 0))
        self.wave_direction_model = Model([64] * 16, (16, 6, 0), 256)
        L = self.levels["luma"]
        low, high = self.limits("luma")
        f = [8 if self.blend == SUM else 5 + 9 * (L - code) // L if 0 <= code <= L else 1 for code in range(low, high + 1)]
        self.luma_model = Model(f, (32, 20, 10), 192)
        low, high = self.limits("alpha")
        self.alpha_model = Model([4] * (high - low + 1), (32, 8, 2), 256)
        self.opacity_model = Model([16] * (self.step["opacity"] + 1), (32, 8, 0), 256)
        self.chroma = Chroma(self.levels["chroma"])

    def read_scalar_splat(self, coder, layer, major, x, y):
        splat = Splat()
        splat.layer, splat.major = layer, major
        size_row = major - self.size_origin
        splat.aspect = 0
        if self.has_anisotropy:
            splat.aspect = self.aspect_model.decode(coder, clamp(size_row + 10, 0, 23), min(major, 23) + 1)
            if splat.aspect == 23:
                splat.aspect += coder.uniform(major - 22)
        C = self.angle_count(splat.aspect)
        splat.angle = self.read_angle(coder, C, min(splat.aspect // 2, 7)) if self.has_rotation and C > 1 else 0
        parts = self.parts(splat.aspect)
        splat.part = part = coder.uniform(parts)
        steep = C < 4 * splat.angle < 3 * C
        splat.cell = x, y
        splat.parts_x, splat.parts_y = (parts, 1) if steep else (1, parts)
        splat.x, splat.y = (x * parts + part, y) if steep else (x, y * parts + part)
        splat.F = self.fineness(major, splat.aspect)
        fine = lambda level: level * splat.F + coder.uniform(splat.F)
        splat.luma = fine(self.limits("luma")[0] + self.luma_model.decode(coder))
        splat.co, splat.cg = map(fine, self.read_chroma(coder, splat)) if self.has_chroma else (0, 0)
        splat.alpha = self.limits("alpha")[0] + self.alpha_model.decode(coder) if self.has_alpha else 0
        splat.opacity = self.opacity_model.decode(coder) if self.has_opacity else 0
        splat.amplitude = splat.wave = splat.direction = splat.phase = 0
        if self.has_texture and self.textured_model.decode(coder, clamp(size_row + 10, 0, 23) // 2):
            self.read_wave(coder, splat)
        return splat

    def read_angle(self, coder, C, row):
        start = [ceil_quotient(C * (2 * b - 1), 32) for b in range(17)]
        codes = [start[b + 1] - start[b] for b in range(16)]
        per = ceil_quotient(C, 16)
        d = self.direction_model.f[row]
        b = coder.decode([1 + (d[b] * codes[b] * (65536 // per) >> 16) if codes[b] else 0 for b in range(16)])
        angle = (start[b] + coder.uniform(codes[b]) + C) % C
        self.direction_model.update(row, b)
        return angle

    def read_wave(self, coder, splat):
        splat.amplitude = 1 + self.amplitude_model.decode(coder, 0)
        splat.wave = self.wave_model.decode(coder, 0)
        model = self.wave_direction_model
        splat.direction = model.decode(coder)
        if splat.direction == 0:
            model.add(15, 6)
        if splat.direction == 15:
            model.add(0, 6)
        splat.phase = coder.uniform(8)

    def read_chroma(self, coder, splat):
        step = self.grid_step(splat.major)
        bx = min(31, (2 * splat.x + 1) * step * 32 // (512 * self.width * splat.parts_x))
        by = min(31, (2 * splat.y + 1) * step * 32 // (512 * self.height * splat.parts_y))
        return self.chroma.decode(coder, bx, by)

    # ------------------------------------------------------------------------------------------ limits

    def check_work(self):
        pixels = self.width * self.height
        work = 0
        for splat in self.splats:
            s1, s2 = self.whole_axes(splat)
            s1, s2 = max(s1, ceil_quotient(s2, 256)), max(s2, ceil_quotient(s1, 256))
            work += min(pixels, 48 * s1 * s2 + 16 * (s1 + s2) + 16)
        if work > 256 * pixels + (1 << 26):
            raise NotAllowed("the work to draw the file is above the limit")

    def whole_axes(self, splat):
        if self.coding == SCALAR:
            return [(self.sigma(code) + 65535) >> 16 for code in (splat.major, splat.major - splat.aspect)]
        M = (1 << self.shape_bits) - 1
        axes = []
        for (low, high), c in zip(self.shape_ranges[:1 + self.has_anisotropy], self.shape_words[splat.shape]):
            v = ceil_quotient(low * M + c * (high - low), M)
            axes.append(((T[v % 32] << (v // 32)) + (1 << 28) - 1) >> 28)
        return axes[0], axes[-1]

    # ------------------------------------------------------------------------------------------ codes as text

    def codes(self):
        """The decoded codes as text, as ../conformance/README.md describes it."""
        lines = [f'block {kind} {content.hex() or "-"}' for kind, content in self.blocks if kind in KNOWN_BLOCKS]
        add = lambda word, *numbers: lines.append(" ".join([word, *map(str, numbers)]))
        add("size", self.width, self.height)
        add("kind", self.blend, self.coding, self.layout, self.high_bit_depth, *(getattr(self, flag) for flag in FLAGS), self.layers)
        add("background", *(self.background or ()))
        if self.coding == SCALAR:
            add("steps", *self.step.values(), self.pivot)
        elif self.n > 0:
            add("bits", self.position_bits, self.shape_bits, self.colour_bits)
            ranges = self.shape_ranges + self.colour_ranges
            for name, rows in ("range", ranges), ("shape", self.shape_words), ("colour", self.colour_words):
                for row in rows:
                    add(name, *row)
        add("splats", self.n)
        for s in self.splats:
            if self.coding == SCALAR:
                add("splat", s.major, s.aspect, s.angle, s.x, s.y, s.luma, s.co, s.cg, s.alpha, s.opacity, s.amplitude,
                    s.wave, s.direction, s.phase, s.layer)
            else:
                add("splat", s.shape, s.colour, s.x, s.y)
        return "\n".join(lines) + "\n"

    def codes_hash(self):
        return hash_of(self.codes())

    # ------------------------------------------------------------------------------------------ rendering

    def gaussians(self):
        return [self.scalar_gaussian(s) if self.coding == SCALAR else self.codebook_gaussian(s) for s in self.splats]

    def scalar_gaussian(self, splat):
        """(centre x, y, s1, s2, theta, opacity, colour and alpha, amplitude, wavelength, direction, phase)"""
        length = lambda code: min(2.0 ** (code * (self.step["scale"] + 4) / 32 - 1), 2.0 ** 15)
        step = self.grid_step(splat.major)
        centre = ((2 * splat.x + 1) * step // splat.parts_x / 512, (2 * splat.y + 1) * step // splat.parts_y / 512)
        theta = splat.angle * math.pi / self.angle_count(splat.aspect)
        opacity = (splat.opacity + 1) / (self.step["opacity"] + 1) if self.has_opacity else 1.0
        colour = [splat.luma / (self.levels["luma"] * splat.F)]
        if self.has_chroma:
            co, cg = (code / (self.levels["chroma"] * splat.F) for code in (splat.co, splat.cg))
            t = colour[0] - cg / 2
            colour = [t - co / 2 + co, colour[0] + cg / 2, t - co / 2]
        if self.has_alpha:
            colour.append(splat.alpha / self.levels["alpha"])
        amplitude = min(2 * splat.amplitude / (3 * self.levels["luma"]), 1.0)
        if splat.major * (self.step["scale"] + 4) > 416:
            amplitude = 0.0
        wave = (amplitude, 2.5 * 2 ** (7 * splat.wave / 16),
                splat.direction * math.pi / 16, splat.phase * math.pi / 4)
        return (*centre, length(splat.major), length(splat.major - splat.aspect), theta, opacity, colour, *wave)

    def codebook_gaussian(self, splat):
        def values(ranges, word, bits):
            return [low + c * (high - low) / ((1 << bits) - 1) for (low, high), c in zip(ranges, word)]
        shape = values(self.shape_ranges, self.shape_words[splat.shape], self.shape_bits)
        colour = [v / 255 for v in values(self.colour_ranges, self.colour_words[splat.colour], self.colour_bits)]
        theta = shape.pop() * math.pi / 256 if self.has_rotation else 0.0
        opacity = colour.pop() if self.has_opacity else 1.0
        s1, s2 = 2 ** (shape[0] / 32 - 4), 2 ** (shape[-1] / 32 - 4)
        centre = [((2 * code + 1) * side * 256 >> self.position_bits) / 512
                  for code, side in ((splat.x, self.width), (splat.y, self.height))]
        return (*centre, s1, s2, theta, opacity, colour, 0.0, 1.0, 0.0, 0.0)

    def draw(self, window=None):
        """Rows of the coded channels' values, before they are clamped, of the pixels in the window (x, y, width, height)."""
        return [[values for values, _ in row] for row in self.draw_with_scale(window)]

    def draw_with_scale(self, window=None):
        """Likewise, each with S of the section "Precision", less what splats contribute where q is at least 7."""
        x0, y0, width, height = window or (0, 0, self.width, self.height)
        gaussians = self.gaussians()
        background = self.drawn_background([gaussian[6] for gaussian in gaussians])
        # Sums of the channels of each pixel, then the numerator of S and the denominator of all.
        e = 1 / 1024
        start = [b * e for b in background] + [e, e] if self.blend == NORMALIZED else background + [1.0, 1.0]
        sums = [[list(start) for _ in range(width)] for _ in range(height)]
        for gaussian in gaussians:
            self.add_gaussian(sums, x0, y0, gaussian)
        return [[([value / pixel[-1] for value in pixel[:-2]], pixel[-2] / pixel[-1]) for pixel in row] for row in sums]

    def drawn_background(self, colours):
        """The background as it is drawn; None stands for the mean of the splats' colours."""
        if self.background is None:
            return [sum(channel) / len(colours) for channel in zip(*colours)] or [0.0] * self.channels
        return [value / (65535 if self.high_bit_depth else 255) for value in self.background]

    def add_gaussian(self, sums, x0, y0, gaussian):
        mx, my, s1, s2, theta, opacity, colour, amplitude, wavelength, direction, phase = gaussian
        s1, s2 = max(s1, s2 / 256), max(s2, s1 / 256)
        cos, sin = math.cos(theta), math.sin(theta)
        cutoff = math.exp(-7)
        # Half the width and height of the ellipse q = 7.
        half_x = math.sqrt(14 * ((s1 * cos) ** 2 + (s2 * sin) ** 2))
        half_y = math.sqrt(14 * ((s1 * sin) ** 2 + (s2 * cos) ** 2))
        rows = range(max(y0, math.floor(my - half_y - 1)), min(y0 + len(sums), math.ceil(my + half_y + 1)))
        columns = range(max(x0, math.floor(mx - half_x - 1)), min(x0 + len(sums[0]), math.ceil(mx + half_x + 1)))
        wx, wy = (2 * math.pi / wavelength * f(direction) for f in (math.cos, math.sin))
        colours = len(colour) - self.has_alpha
        for j in rows:
            row = sums[j - y0]
            dy = j + 0.5 - my
            for i in columns:
                dx = i + 0.5 - mx
                q = 0.5 * (((dx * cos + dy * sin) / s1) ** 2 + ((dy * cos - dx * sin) / s2) ** 2)
                if q >= 7:
                    continue
                full = math.exp(-q)
                weight = opacity * (full - cutoff)
                wave = amplitude * math.cos(dx * wx + dy * wy - phase) if amplitude else 0.0
                pixel = row[i - x0]
                if self.blend == ALPHA:
                    weight = min(weight, 0.999)
                    for k in range(len(colour) + 1):
                        pixel[k] *= 1 - weight
                for k, c in enumerate(colour):
                    pixel[k] += weight * (c + wave if k < colours else c)
                pixel[-2] += opacity * full
                if self.blend == NORMALIZED:
                    pixel[-1] += weight

    def samples(self, window=None):
        """Rows of pixels of samples 0..1 in the layout of the source: 1 to 4 samples each."""
        return [[self.output(pixel) for pixel in row] for row in self.draw(window)]

    def output(self, pixel):
        colour = list(pixel[:-1]) if self.has_alpha else list(pixel)
        alpha = clamp(pixel[-1], 0.0, 1.0) if self.has_alpha else 1.0
        if self.layout in (RGB, RGB_ALPHA) and not self.has_chroma:
            colour *= 3
        if self.layout in (GREY, RGB):
            return [clamp(c, 0.0, 1.0) for c in colour]
        return [clamp(c, 0.0, alpha) / alpha if alpha > 0 else 0.0 for c in colour] + [alpha]

    def integers(self, window=None):
        """Rows of rounded samples of 8 or 16 bits."""
        highest = 65535 if self.high_bit_depth else 255
        return [[[math.floor(highest * v + 0.5) for v in pixel] for pixel in row] for row in self.samples(window)]


def hash_of(codes):
    return hashlib.sha256(codes.encode()).hexdigest()


class Chroma:
    """Prediction and coding of Co and Cg."""

    def __init__(self, L):
        self.L = L
        peak = lambda width: [1 + 150 // (1 + (i - width) ** 2) for i in range(2 * width + 1)]
        self.plain = [Model(peak(L), (150, 6, 0), 600) for _ in range(2)]
        self.residual = [Model(peak(2 * L), (150, 14, 2), 400) for _ in range(2)]
        self.weight = [40000, 40000]
        self.pyramid = [{} for _ in range(6)]
        self.XX, self.XY = 2048, 0

    def decode(self, coder, bx, by):
        L = self.L
        m = [0, 0]
        for level, buckets in enumerate(self.pyramid):
            m = buckets.get((bx >> (5 - level), by >> (5 - level)), m)
        m = list(m)
        co = self.decode_channel(coder, 0, (m[0] + 8) >> 4)
        t = m[1] + quotient(self.XY * (16 * co - m[0]), self.XX)
        cg = self.decode_channel(coder, 1, (clamp(t, -16 * L, 16 * L) + 8) >> 4)
        d = 16 * co - m[0]
        self.XX += d * d
        self.XY += d * (16 * cg - m[1])
        for level, buckets in enumerate(self.pyramid):
            place = bx >> (5 - level), by >> (5 - level)
            if place in buckets:
                mean = buckets[place]
                for channel, code in enumerate((co, cg)):
                    mean[channel] += quotient(16 * code - mean[channel], 3)
            else:
                buckets[place] = [16 * co, 16 * cg]
        return co, cg

    def decode_channel(self, coder, channel, predicted):
        L = self.L
        plain, residual, W = self.plain[channel], self.residual[channel], self.weight[channel]
        s = L - predicted
        p, r = plain.f, residual.f[s:s + 2 * L + 1]
        R, P = sum(r), sum(p)
        u = W * 16384 // P
        v = (65536 - W) * 16384 // R
        i = coder.decode([1 + ((p[i] * u + r[i] * v) >> 15) for i in range(2 * L + 1)])
        a = p[i] * 16384 // P + 1
        b = r[i] * 16384 // R + 1
        self.weight[channel] = clamp(W * a * 65536 // (W * a + (65536 - W) * b), 2048, 63488)
        plain.update(i)
        residual.update(s + i)
        return i - L


# ---------------------------------------------------------------------------------------------- set coding

def split(coder, n, A, B):
    shift = 0
    while n >> shift > 255:
        shift += 1
    while A > 65535 or B > 65535:
        A, B = (A + 1) // 2, (B + 1) // 2
    m = n >> shift

    def numerator(k):
        return (m - k) * (A + 64 * k)

    def denominator(k):
        return (k + 1) * (B + 64 * (m - 1 - k))

    excess = m * (A - 64) - (B - 64)
    slope = (A - 64) + (B - 64)
    if excess <= 0:
        mode = 0
    elif slope <= 0 or excess >= m * slope:
        mode = m
    else:
        mode = ceil_quotient(excess, slope)
    w = [0] * (m + 1)
    w[mode] = 1 << 32
    for k in range(mode, m):
        w[k + 1] = w[k] * numerator(k) // denominator(k)
    for k in range(mode, 0, -1):
        w[k - 1] = w[k] * denominator(k - 1) // numerator(k - 1)
    total = sum(w)
    left = coder.decode([1 + weight * (65535 - m) // total for weight in w]) << shift
    if shift > 0:
        left += coder.uniform(min(1 << shift, n - left + 1))
    return left


def collect_priors(earlier):
    """The priors of a class, after the lists of positions of the classes before it."""
    priors = []
    for positions in reversed(earlier):
        if len(priors) + len(positions) > 4096:
            break
        priors.extend(positions)
    return priors


def split_axis(w, h, pitch):
    return 0 if w > 1 and (h == 1 or w * pitch[0] >= h * pitch[1]) else 1


def halves_to(cell, size, pitch):
    """The halves in which `points` finds a cell of a grid, 0 for the first: the order of cells is that of these lists."""
    at, size, halves = list(cell), list(size), []
    while size != [1, 1]:
        axis = split_axis(*size, pitch)
        a = size[axis] // 2
        halves.append(int(at[axis] >= a))
        at[axis] -= a * halves[-1]
        size[axis] = size[axis] - a if halves[-1] else a
    return halves


def points(coder, cells, pitch, rectangle, n, priors):
    """Appends the cells of n points in the rectangle (x0, y0, w, h) to `cells`."""
    x0, y0, w, h = rectangle
    if n == 0:
        return
    if w == 1 and h == 1:
        cells.extend([(x0, y0)] * n)
        return
    axis = split_axis(w, h, pitch)
    size = rectangle[2 + axis]
    a = size // 2
    first, second = [], []
    if w <= 128 and h <= 128:
        A = 1024 * a // size
        B = 1024 - A
    else:
        border = 2 * (rectangle[axis] + a) * pitch[axis]
        first = [position for position in priors if position[axis] < border]
        second = [position for position in priors if position[axis] >= border]
        A = 192 * a // size
        B = 192 - A + 16 * len(second)
        A += 16 * len(first)
    left = split(coder, n, A, B)
    halves = ((x0, y0, a, h), (x0 + a, y0, w - a, h)) if axis == 0 else ((x0, y0, w, a), (x0, y0 + a, w, h - a))
    points(coder, cells, pitch, halves[0], left, first)
    points(coder, cells, pitch, halves[1], n - left, second)


# ---------------------------------------------------------------------------------------------- files

def crc16(data):
    crc = 0xFFFF
    for byte in data:
        crc ^= byte << 8
        for _ in range(8):
            crc <<= 1
            if crc & 0x10000:
                crc ^= 0x11021
    return crc ^ 0xFFFF


class UnknownBlock(Exception):
    """A mandatory block of an unknown type."""


KNOWN_BLOCKS = {0: "colour space", 1: "ICC profile", 32: "EXIF", 33: "XMP"}


def read_blocks(data, position, end, types):
    """Returns the blocks (type, content) and the position after them."""
    blocks = []

    def byte():
        nonlocal position
        if position >= end:
            raise BeyondEnd("a block needs bytes beyond the end")
        position += 1
        return data[position - 1]

    last = False
    while not last:
        head = byte()
        kind, mandatory, last = head & 63, head >> 6 & 1, head >> 7
        if kind not in types or blocks and kind <= blocks[-1][0]:
            raise NotAllowed(f"a block of type {kind} is not allowed here")
        size = 0
        for group in range(3):
            value = byte()
            size |= (value & 127) << 7 * group
            if value < 128:
                break
        if value > 127 or value == 0 and group > 0:
            raise NotAllowed("the size of a block is not a varint")
        if size > end - position:
            raise BeyondEnd("a block needs bytes beyond the end")
        if mandatory and kind not in KNOWN_BLOCKS:
            raise UnknownBlock(f"type {kind}")
        if kind == 0 and size != 2:
            raise NotAllowed("a colour space has two bytes")
        blocks.append((kind, data[position:position + size]))
        position += size
    return blocks, position


def read_picture(data, start, end):
    """Reads a whole picture."""
    coder = RangeDecoder(data, start, end)
    picture = Picture()
    picture.read_header(coder)
    picture.read_splats(coder, end - start)
    if coder.bytes_read() != end - start + 3:
        raise NotAllowed("bytes follow the picture")
    picture.check_work()
    picture.certain = picture.n
    return picture


def decode(data, bare=False):
    """Reads a file, or a list of packets, from its bytes; raises Refused."""
    if bare:
        return read_bare(data)
    return read_list(data) if data[:4] == LIST_MAGIC else read_complete(data)


def read_bare(data):
    try:
        return read_picture(data, 0, len(data))
    except BeyondEnd as error:
        raise Refused(TRUNCATED, error) from None
    except NotAllowed as error:
        raise Refused(CORRUPT, error) from None


def check_start(data):
    if len(data) < 4 or data[:4] != b"\xC7gsc" or len(data) > 4 and data[4] & 15 < 2:
        raise Refused(NOT_GSCL, "the first bytes are not those of gscl")
    if len(data) > 4 and data[4] & 15 > 2:
        raise Refused(NEWER, f"version {data[4] & 15}")


def check_flags(data):
    if data[4] >> 6:
        raise NotAllowed("bits that must be zero are set")


def read_complete(data):
    check_start(data)
    if len(data) < 7:
        raise Refused(TRUNCATED, "fewer than 7 bytes")
    if crc16(data[:-2]) != int.from_bytes(data[-2:], "big"):
        raise Refused(*why_no_check(data))
    try:
        return read_parts(data)
    except UnknownBlock as error:
        raise Refused(UNKNOWN_BLOCK, error) from None
    except (BeyondEnd, NotAllowed) as error:
        raise Refused(CORRUPT, error) from None


def why_no_check(data):
    """The result for a file whose check does not match."""
    start, end = 5, len(data) - 2
    try:
        check_flags(data)
        if data[4] & 16:
            start = read_blocks(data, start, end, range(32))[1]
        read_picture(data, start, end)
    except BeyondEnd as error:
        return TRUNCATED, error
    except (NotAllowed, UnknownBlock):
        pass
    return DAMAGED, "the check does not match"


def read_parts(data):
    """The parts of a file whose check matches."""
    flags = data[4]
    check_flags(data)
    start, end = 5, len(data) - 2
    before, after = [], []
    if flags & 16:
        before, start = read_blocks(data, start, end, range(32))
    if flags & 32:
        size = int.from_bytes(data[end - 4:end], "little")
        if size > end - 7 - start:
            raise NotAllowed("the list of blocks after the picture is too long")
        list_end = end - 4
        end = list_end - size - 3
        if any(data[end:end + 3]):
            raise NotAllowed("the bytes after the picture are not zero")
        after, position = read_blocks(data, end + 3, list_end, range(32, 64))
        if position != list_end:
            raise NotAllowed("the list of blocks ends early")
    picture = read_picture(data, start, end)
    picture.blocks = before + after
    return picture


def decode_prefix(data, bare=False):
    """What the first bytes of a file show: the picture with the splats that are certain.

    Raises Refused when not even the header has come, and for other reasons than missing bytes.
    """
    try:
        return decode(data, bare)
    except Refused as error:
        if error.result not in (TRUNCATED, DAMAGED) or data[:4] == LIST_MAGIC:
            raise
    start, end = 0, len(data)
    if not bare:
        check_start(data)
        if len(data) < 7:
            raise Refused(TRUNCATED, "fewer than 7 bytes")
        start, end = 5, len(data) - 2
        try:
            check_flags(data)
            if data[4] & 16:
                start = read_blocks(data, start, end, range(32))[1]
        except BeyondEnd as error:
            raise Refused(TRUNCATED, error) from None
        except (NotAllowed, UnknownBlock) as error:
            raise Refused(CORRUPT, error) from None
    coder = RangeDecoder(data, start, end, beyond=math.inf)
    picture = Picture()
    picture.read_header(coder)
    if coder.bytes_read() > end - start:
        raise Refused(TRUNCATED, "the header has not come")
    coder.beyond = 0
    try:
        picture.read_splats(coder, end - start)
    except (BeyondEnd, NotAllowed):
        pass
    del picture.splats[picture.certain:]
    return picture


# ---------------------------------------------------------------------------------------------- packets

LIST_MAGIC = b"\xC7gsp"
NO_IDENTITY = 0xC7


def packets_of(data):
    """The complete packets of a list."""
    position, packets = 4, []
    while True:
        size = 0
        for group in range(3):
            if position >= len(data):
                return packets
            value = data[position]
            position += 1
            size |= (value & 127) << 7 * group
            if value < 128:
                break
        if value > 127 or value == 0 and group > 0 or size > len(data) - position:
            return packets
        packets.append(data[position:position + size])
        position += size


class Packet:
    """A packet whose check matches, with its header up to N."""

    def __init__(self, data):
        self.data = data
        self.start = Picture(in_packet=True)
        self.start.read_header_to_n(RangeDecoder(data, 1, len(data) - 2))
        self.number = self.start.k

    def kind(self):
        """What is equal in all packets of a picture, of the header up to N."""
        s = self.start
        return (self.data[0], s.K, s.blend, s.layout, s.high_bit_depth, *(getattr(s, flag) for flag in FLAGS), s.width, s.height)

    def picture(self):
        """The whole packet; None where it is not valid."""
        end = len(self.data) - 2
        coder = RangeDecoder(self.data, 1, end)
        picture = Picture(in_packet=True)
        try:
            picture.read_header(coder)
            picture.read_splats(coder, end - 1)
            if coder.bytes_read() != end - 1 + 3:
                return None
            picture.check_work()
        except (BeyondEnd, NotAllowed):
            return None
        return picture


def intact_packets(all_packets):
    """Of the first packet's picture the packets whose header can be read: {number: Packet}, in their order."""
    found = {}
    for data in all_packets:
        if len(data) < 4 or data[0] == NO_IDENTITY or crc16(data[:-2]) != int.from_bytes(data[-2:], "big"):
            continue
        try:
            packet = Packet(data)
        except BeyondEnd:
            continue
        first = next(iter(found.values()), packet)
        if packet.kind() == first.kind():
            found.setdefault(packet.number, packet)
    return found


def read_list(data):
    """Reads the picture of a list of packets; raises Refused."""
    all_packets = packets_of(data)
    if not all_packets:
        raise Refused(TRUNCATED, "no packet is complete")
    packets = intact_packets(all_packets)
    if packets:
        packets = intact_packets(all_packets + repaired_packets(packets, all_packets))
    picture = None
    for packet in packets.values():
        picture = picture_with(picture, packet.picture())
    if picture is None:
        raise Refused(DAMAGED, "no packet of the list is valid")
    picture.splats = in_stored_order(picture)
    picture.n = picture.certain = len(picture.splats)
    return picture


def picture_with(picture, packet):
    """The picture with the splats of one packet more, where they belong together and the limits hold.  Each may be None."""
    if picture is None or packet is None:
        return packet or picture
    if not packet.splats:
        return picture
    if not picture.splats:
        return packet
    if any(getattr(packet, name) != getattr(picture, name) for name in ("step", "pivot", "background")):
        return picture
    before = picture.splats
    picture.splats = before + packet.splats
    try:
        if len(picture.splats) > 1048576:
            raise NotAllowed("there are too many splats")
        picture.check_work()
    except NotAllowed:
        picture.splats = before
    return picture


def in_stored_order(picture):
    """The splats, those that are equal in all codes once."""
    grids = {major: Grid(picture.cells(major, picture.width), picture.cells(major, picture.height), 1, 1)
             for major in {splat.major for splat in picture.splats}}

    def place(splat):
        grid = grids[splat.major]
        return -splat.major, halves_to(splat.cell, grid.size, grid.pitch), splat.scalar_codes()

    distinct = {(splat.major, splat.cell, splat.scalar_codes()): splat for splat in picture.splats}
    return sorted(distinct.values(), key=place)


# ---- repair packets

POWERS = [1]
while len(POWERS) < 255:
    POWERS.append(POWERS[-1] << 1 ^ (0x11D if POWERS[-1] & 128 else 0))
LOGARITHMS = {power: exponent for exponent, power in enumerate(POWERS)}


def multiply(a, b):
    """The product of two bytes as elements of GF(256)."""
    return POWERS[(LOGARITHMS[a] + LOGARITHMS[b]) % 255] if a and b else 0


def inverse(a):
    return POWERS[-LOGARITHMS[a] % 255]


def add_multiple(row, factor, other):
    row[:] = [a ^ multiply(factor, b) for a, b in zip(row, other)]


def repair_contents(packets, all_packets):
    """The contents of the repair packets for these packets, by their numbers, all of the same length."""
    first = next(iter(packets.values()))
    contents = {}
    for data in all_packets:
        if len(data) < 5 or data[0] != first.data[0] or crc16(data[:-2]) ^ 0xFFFF != int.from_bytes(data[-2:], "big"):
            continue
        length = len(next(iter(contents.values()), data[2:-2]))
        if data[1] >= first.start.K and len(data) - 4 == length:
            contents.setdefault(data[1], data[2:-2])
    return contents


def repaired_packets(packets, all_packets):
    """Those that a list lacks and that its repair packets make up for."""
    first = next(iter(packets.values()))
    contents = repair_contents(packets, all_packets)
    missing = [k for k in range(first.start.K) if k not in packets]
    if not missing or len(contents) < len(missing):
        return []
    if any(len(packet.data) - 1 > len(next(iter(contents.values()))) for packet in packets.values()):
        return []
    rows = [equation(r, content, packets, missing) for r, content in contents.items()][:len(missing)]
    solve(rows, len(missing))
    ended = (ended_packet(first.data[:1] + bytes(row[len(missing):])) for row in rows)
    return [packet for packet in ended if packet is not None]


def equation(r, content, packets, missing):
    """The factors of the missing packets, then what they add up to."""
    rest = list(content)
    for k, packet in packets.items():
        known = packet.data[1:]
        add_multiple(rest, inverse(r ^ k), known + bytes(len(rest) - len(known)))
    return [inverse(r ^ k) for k in missing] + rest


def solve(rows, count):
    """Makes the first `count` columns those of the identity matrix, which is possible for the factors of repair packets."""
    for column in range(count):
        factor = inverse(rows[column][column])
        rows[column][:] = [multiply(factor, a) for a in rows[column]]
        for row in rows:
            if row is not rows[column]:
                add_multiple(row, row[column], rows[column])


def ended_packet(data):
    """A computed packet without the zeros behind it; None where no check matches."""
    end = len(data.rstrip(b"\0"))
    for size in range(max(end, 4), len(data) + 1):
        if crc16(data[:size - 2]) == int.from_bytes(data[size - 2:size], "big"):
            return data[:size]
    return None


def list_of_one(packet):
    return LIST_MAGIC + varint(len(packet)) + packet


def varint(value):
    return bytes([value]) if value < 128 else bytes([value & 127 | 128]) + varint(value >> 7)


# ---------------------------------------------------------------------------------------------- the command

def png_bytes(picture):
    """The drawn picture as a PNG of 8 bits a sample, or of 16 with high_bit_depth."""
    form = ">H" if picture.high_bit_depth else "B"
    colour_type = [0, 4, 2, 6][picture.layout]
    raw = b"".join(b"\0" + b"".join(struct.pack(form, v) for pixel in row for v in pixel) for row in picture.integers())

    def chunk(name, content):
        return struct.pack(">I", len(content)) + name + content + struct.pack(">I", zlib.crc32(name + content))

    head = struct.pack(">IIBBBBB", picture.width, picture.height, 16 if picture.high_bit_depth else 8, colour_type, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(raw, 9)) + chunk(b"IEND", b"")


def main():
    parser = argparse.ArgumentParser(description="Decodes gscl files as format/FORMAT.md defines them.")
    parser.add_argument("file")
    parser.add_argument("out", nargs="?", metavar="OUT.png")
    parser.add_argument("--bare", action="store_true", help="the file is of the bare form")
    parser.add_argument("--codes", action="store_true", help="print the decoded codes")
    parser.add_argument("--hash", action="store_true", help="print the SHA-256 of the decoded codes")
    parser.add_argument("--partial", action="store_true", help="draw what a prefix of a file shows")
    arguments = parser.parse_args()
    with open(arguments.file, "rb") as file:
        data = file.read()
    if data[:3] != LIST_MAGIC[:3] and not arguments.bare:
        data = list_of_one(data)
    try:
        picture = (decode_prefix if arguments.partial else decode)(data, arguments.bare)
    except Refused as error:
        sys.exit(f"gscl_decoder: {arguments.file}: {error}")
    if arguments.out:
        with open(arguments.out, "wb") as file:
            file.write(png_bytes(picture))
    elif arguments.codes:
        sys.stdout.write(picture.codes())
    elif arguments.hash:
        print(picture.codes_hash())
    else:
        print(f"{picture.width}x{picture.height}, {picture.n} splats, {picture.certain} of them certain")


if __name__ == "__main__":
    main()
