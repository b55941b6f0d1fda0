"""Colour profiles and EXIF blocks for tests, and the colours that they mean.  Uses the standard library only."""
import struct

from images import srgb_to_linear

# x and y of white, red, green and blue.
SRGB = ((0.3127, 0.3290), (0.640, 0.330), (0.300, 0.600), (0.150, 0.060))
DISPLAY_P3 = ((0.3127, 0.3290), (0.680, 0.320), (0.265, 0.690), (0.150, 0.060))
BT2020 = ((0.3127, 0.3290), (0.708, 0.292), (0.170, 0.797), (0.131, 0.046))
ADOBE_RGB = ((0.3127, 0.3290), (0.640, 0.330), (0.210, 0.710), (0.150, 0.060))
ADOBE_RGB_GAMMA = 563 / 256

D50 = (0.9642, 1.0, 0.8249)
BRADFORD = ((0.8951, 0.2664, -0.1614), (-0.7502, 1.7135, 0.0367), (0.0389, -0.0685, 1.0296))


# ---- Colours --------------------------------------------------------------------------------------

def multiply(a, b):
    return [[sum(x * b[k][j] for k, x in enumerate(row)) for j in range(len(b[0]))] for row in a]


def inverse(m):
    """Of a 3 x 3 matrix."""
    def minor(i, j):
        (a, b), (c, d) = [[m[y][x] for x in range(3) if x != i] for y in range(3) if y != j]
        return (a * d - b * c) * (-1) ** (i + j)
    determinant = sum(m[0][j] * minor(j, 0) for j in range(3))
    return [[minor(i, j) / determinant for j in range(3)] for i in range(3)]


def xyz(xy):
    return [xy[0] / xy[1], 1.0, (1 - xy[0] - xy[1]) / xy[1]]


def to_xyz(primaries):
    """The matrix from linear RGB to XYZ relative to the white of the primaries."""
    white, *colours = primaries
    columns = list(zip(*map(xyz, colours)))
    scale = multiply(inverse(columns), [[v] for v in xyz(white)])
    return [[value * scale[j][0] for j, value in enumerate(row)] for row in columns]


def to_d50(primaries):
    """The same, adapted to D50 as in colour profiles."""
    cones = multiply(BRADFORD, [[v] for v in xyz(primaries[0])])
    target = multiply(BRADFORD, [[v] for v in D50])
    diagonal = [[target[i][0] / cones[i][0] if i == j else 0.0 for j in range(3)] for i in range(3)]
    return multiply(multiply(inverse(BRADFORD), multiply(diagonal, BRADFORD)), to_xyz(primaries))


def linear_to_srgb(value):
    return 12.92 * value if value <= 0.0031308 else 1.055 * value ** (1 / 2.4) - 0.055


def srgb_of(colour, primaries, gamma=None):
    """A colour in 0..1 of other primaries (and gamma; default: the curve of sRGB) in sRGB, clipped to 0..1."""
    linear = [[srgb_to_linear(v) if gamma is None else v ** gamma] for v in colour]
    result = multiply(multiply(inverse(to_d50(SRGB)), to_d50(primaries)), linear)
    return [linear_to_srgb(min(max(row[0], 0.0), 1.0)) for row in result]


def lab_to_xyz(lab):
    """A colour of CIELAB relative to a white of 1, 1, 1."""
    middle = (lab[0] + 16) / 116
    return [v ** 3 if v > 6 / 29 else 3 * (6 / 29) ** 2 * (v - 4 / 29)
            for v in (middle + lab[1] / 500, middle, middle - lab[2] / 200)]


def srgb_of_lab(lab, black):
    """A colour of CIELAB, white D50, in sRGB, after black point compensation for a grey of lightness `black`."""
    least = lab_to_xyz((black, 0, 0))[1]
    scaled = [(v - least) / (1 - least) for v in lab_to_xyz(lab)]
    linear = multiply(inverse(to_d50(SRGB)), [[v * white] for v, white in zip(scaled, D50)])
    return [linear_to_srgb(min(max(row[0], 0.0), 1.0)) for row in linear]


# ---- Profiles -------------------------------------------------------------------------------------

def fixed(value):
    return struct.pack(">i", round(value * 65536))


def curve_tag(gamma):
    if gamma is not None:
        return b"curv" + bytes(4) + struct.pack(">IH", 1, round(gamma * 256)) + bytes(2)
    return b"para" + bytes(4) + struct.pack(">HH", 3, 0) + b"".join(
        fixed(v) for v in (2.4, 1 / 1.055, 0.055 / 1.055, 1 / 12.92, 0.04045))


def xyz_tag(values):
    return b"XYZ " + bytes(4) + b"".join(map(fixed, values))


def text_tag(text):
    encoded = text.encode("utf-16-be")
    return b"mluc" + bytes(4) + struct.pack(">II2s2sII", 1, 12, b"en", b"US", len(encoded), 28) + encoded


def icc_file(space, connection, tags, kind=b"mntr"):
    """A profile of version 4.  `tags` are pairs of a signature and contents."""
    at, table, data = 128 + 4 + 12 * len(tags), b"", b""
    for name, content in tags:
        content += bytes(-len(content) % 4)
        table += struct.pack(">4sII", name, at + len(data), len(content))
        data += content
    body = struct.pack(">I", len(tags)) + table + data
    header = struct.pack(">I4sI4s4s4s12s4s", 128 + len(body), bytes(4), 0x04200000, kind, space, connection, bytes(12),
                         b"acsp") + bytes(28) + b"".join(map(fixed, D50))
    return header.ljust(128, b"\0") + body


def icc_rgb(primaries, gamma=None, name="Test RGB"):
    columns = list(zip(*to_d50(primaries)))
    tags = [(b"desc", text_tag(name)), (b"cprt", text_tag("none")), (b"wtpt", xyz_tag(D50))]
    tags += [(letter + b"XYZ", xyz_tag(column)) for letter, column in zip((b"r", b"g", b"b"), columns)]
    return icc_file(b"RGB ", b"XYZ ", tags + [(letter + b"TRC", curve_tag(gamma)) for letter in (b"r", b"g", b"b")])


def icc_grey(gamma, name="Test Grey"):
    return icc_file(b"GRAY", b"XYZ ", [(b"desc", text_tag(name)), (b"cprt", text_tag("none")), (b"wtpt", xyz_tag(D50)),
                                       (b"kTRC", curve_tag(gamma))])


def icc_cmyk(colours, name="Test CMYK"):
    """Inks whose 16 full combinations have the given colours, (L, a, b) relative to the paper, the last ink changing
    fastest.  The paper is yellowish."""
    identity = b"".join(fixed(1.0 if i % 4 == 0 else 0.0) for i in range(9))
    ramp = bytes(range(256))
    corners = b"".join(bytes((round(l * 2.55), round(a + 128), round(b + 128))) for l, a, b in colours)
    table = b"mft1" + bytes(4) + bytes((4, 3, 2, 0)) + identity + ramp * 4 + corners + ramp * 3
    tags = [(b"desc", text_tag(name)), (b"cprt", text_tag("none")), (b"wtpt", xyz_tag((0.85, 0.88, 0.6))),
            (b"A2B0", table), (b"A2B1", table)]
    return icc_file(b"CMYK", b"Lab ", tags, kind=b"scnr")


# ---- EXIF -----------------------------------------------------------------------------------------

ORIENTATION, EXIF_DIRECTORY, COLOUR_SPACE, INTEROPERABILITY, INDEX = 0x0112, 0x8769, 0xA001, 0xA005, 0x0001
BYTE_SHORT, BYTE_LONG, BYTE_ASCII = 3, 4, 2


def exif_directory(order, at, entries, following=0):
    """A directory at the offset `at`.  Entries are (tag, value): an integer below 65536 is a SHORT, text is ASCII, and
    a list is a directory of its own."""
    data_at = at + 2 + 12 * len(entries) + 4
    table, data = struct.pack(order + "H", len(entries)), b""
    for tag, value in entries:
        here = data_at + len(data)
        if isinstance(value, list):
            table += struct.pack(order + "HHII", tag, BYTE_LONG, 1, here)
            data += exif_directory(order, here, value)
        elif isinstance(value, int):
            table += struct.pack(order + "HHIH2x", tag, BYTE_SHORT, 1, value)
        else:
            text = value.encode() + b"\0"
            table += struct.pack(order + "HHI", tag, BYTE_ASCII, len(text))
            table += text.ljust(4, b"\0") if len(text) <= 4 else struct.pack(order + "I", here)
            data += text + bytes(len(text) % 2) if len(text) > 4 else b""
    return table + struct.pack(order + "I", following) + data


def exif_bytes(entries, order=">"):
    header = struct.pack(order + "2sHI", b"MM" if order == ">" else b"II", 42, 8)
    return header + exif_directory(order, 8, entries)


TYPE_SIZES = {1: 1, 2: 1, 3: 2, 4: 4, 5: 8, 7: 1}


def exif_values(data, at=None):
    """What a structure of TIFF holds, as exif_bytes takes it: tags with integers, text (also for bytes) or a list for
    the directories of EXIF."""
    order = "<" if data[:2] == b"II" else ">"
    at = at or struct.unpack_from(order + "I", data, 4)[0]
    values = []
    for i in range(struct.unpack_from(order + "H", data, at)[0]):
        tag, kind, count = struct.unpack_from(order + "HHI", data, at + 2 + 12 * i)
        place, size = at + 10 + 12 * i, count * TYPE_SIZES[kind]
        number = struct.unpack_from(order + ("H" if kind == BYTE_SHORT else "I"), data, place)[0]
        if tag in (EXIF_DIRECTORY, INTEROPERABILITY):
            values.append((tag, exif_values(data, number)))
        elif kind in (BYTE_SHORT, BYTE_LONG) and count == 1:
            values.append((tag, number))
        else:
            start = place if size <= 4 else number
            values.append((tag, data[start:start + size].rstrip(b"\0").decode("latin-1")))
    return values
