"""The parts of the file format (format/FORMAT.md) that forged files need."""

MAGIC = b"\xc7gsc"
SIDE_LENGTHS = (1, 1, 1, 1, 2, 2, 3, 4, 6, 10, 14, 10, 6, 2, 1)
COUNT_LENGTHS = (2, 1, 1, 2, 4, 6, 8, 7, 7, 6, 5, 4, 2, 1, 1, 1, 1, 1, 1, 1, 1, 1)
RATIOS = (10, 3, 8, 6, 2, 1, 1, 1)


def crc16(data):
    crc = 0xFFFF
    for byte in data:
        crc ^= byte << 8
        for _ in range(8):
            crc <<= 1
            if crc & 0x10000:
                crc ^= 0x11021
    return crc ^ 0xFFFF


class Picture:
    """The symbols of a picture, as one number between 0 and 1 of any precision."""

    def __init__(self):
        self.low, self.range, self.bytes = 0, 0xFFFFFFFF, 4

    def symbol(self, value, frequencies):
        total, cum = sum(frequencies), sum(frequencies[:value])
        unit = self.range // total
        self.low += cum * unit
        self.range = self.range - cum * unit if cum + frequencies[value] == total else frequencies[value] * unit
        while self.range < 1 << 24:
            self.low, self.range, self.bytes = self.low << 8, self.range << 8, self.bytes + 1

    def flag(self, value, n):
        self.symbol(value, (16 - n, n))

    def raw(self, value, bits):
        if bits > 16:
            self.raw(value >> 16, bits - 16)
        self.symbol(value & (1 << min(bits, 16)) - 1, (1,) * (1 << min(bits, 16)))

    def number(self, value, frequencies):
        self.symbol(value.bit_length(), frequencies)
        if value > 1:
            self.raw(value - (1 << value.bit_length() - 1), value.bit_length() - 1)

    def finish(self):
        low = (self.low + 0xFFFFFF) >> 24
        return low.to_bytes(self.bytes - 3, "big")


def header(width, height, splats, codebook=False):
    """The start of a picture in colour, to which symbols can be added."""
    picture = Picture()
    picture.flag(codebook, 4)
    if codebook:
        picture.symbol(0, (10, 4, 2))
        picture.flag(1, 3)
        picture.symbol(2, (5, 2, 4, 5))
        for value, n in ((0, 4), (1, 12), (0, 6), (1, 14), (1, 14)):
            picture.flag(value, n)
    else:
        picture.flag(0, 12)
    picture.flag(0, 8)
    picture.number(max(width, height) - 1, SIDE_LENGTHS)
    picture.symbol(0, RATIOS)
    picture.symbol(min(width, height) - 1, (1,) * max(width, height))
    if width != height:
        picture.flag(width < height, 6)
    picture.number(splats, COUNT_LENGTHS)
    return picture


def contained(picture, version=2, before=b"", after=b""):
    """A file with a check that matches, of a picture and lists of blocks."""
    data = MAGIC + bytes([version | bool(before) << 4 | bool(after) << 5]) + before + picture
    if after:
        data += bytes(3) + after + len(after).to_bytes(4, "little")
    return data + crc16(data).to_bytes(2, "big")


COLOUR_SPACE, ICC, EXIF, XMP = 0, 1, 32, 33


def block(kind, content, last=True):
    """A block of a list.  Its size is a number of 7 bits a byte, least significant first."""
    size, digits = len(content), b""
    while True:
        digits += bytes([size & 127 | (128 if size > 127 else 0)])
        size >>= 7
        if not size:
            return bytes([kind | last << 7]) + digits + content
