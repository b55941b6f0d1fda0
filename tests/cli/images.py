"""Small synthetic images, and minimal readers and writers of image files.

Uses the standard library only.
"""
import array
import dataclasses
import math
import struct
import sys
import zlib


@dataclasses.dataclass
class Image:
    """Interleaved integer samples in 0 .. 2^depth - 1."""
    width: int
    height: int
    channels: int  # 1 grey, 2 grey and alpha, 3 RGB, 4 RGBA
    depth: int  # 8 or 16
    samples: list

    @property
    def peak(self):
        return (1 << self.depth) - 1

    @property
    def has_alpha(self):
        return self.channels % 2 == 0

    def row(self, y):
        size = self.width * self.channels
        return self.samples[y * size:(y + 1) * size]

    def kind(self):
        return self.width, self.height, self.channels, self.depth

    def crop(self, x, y, width, height):
        begin, end = x * self.channels, (x + width) * self.channels
        rows = [self.row(line)[begin:end] for line in range(y, y + height)]
        return Image(width, height, self.channels, self.depth, [sample for row in rows for sample in row])

    def normal(self):
        """Samples scaled to 0..255, with colours multiplied by alpha."""
        values = [255.0 * sample / self.peak for sample in self.samples]
        if self.has_alpha:
            for at in range(0, len(values), self.channels):
                alpha = values[at + self.channels - 1] / 255.0
                for c in range(self.channels - 1):
                    values[at + c] *= alpha
        return values


def psnr(a, b):
    errors = [(x - y) ** 2 for x, y in zip(a.normal(), b.normal(), strict=True)]
    mse = sum(errors) / len(errors)
    return math.inf if mse == 0 else 10 * math.log10(255.0 ** 2 / mse)


def max_difference(a, b):
    """Maximum difference of the stored samples, scaled to 0..255."""
    assert a.kind() == b.kind(), (a.kind(), b.kind())
    return max(abs(x - y) for x, y in zip(a.samples, b.samples)) * 255.0 / a.peak


# ---- Scenes ---------------------------------------------------------------------------------------

def scene(width, height, channels=3, depth=8):
    """A gradient with a bright disc and a dark bar.  Alpha, if any, fades from left to right and is 0 in a corner."""
    peak = (1 << depth) - 1
    samples = []
    for y in range(height):
        for x in range(width):
            u, v = (x + 0.5) / width, (y + 0.5) / height
            disc = 1.0 if (u - 0.6) ** 2 + (v - 0.4) ** 2 < 0.05 else 0.0
            bar = 0.4 if 0.2 < u < 0.3 else 0.0
            colours = [0.2 + 0.6 * u + 0.2 * disc - bar, 0.7 - 0.5 * v + 0.2 * disc, 0.3 + 0.4 * u * v - 0.5 * bar]
            pixel = colours if channels >= 3 else [sum(colours) / 3]
            if channels % 2 == 0:
                pixel = pixel + [0.0 if u > 0.7 and v > 0.7 else 1.0 - 0.6 * u]
            samples += [min(max(round(value * peak), 0), peak) for value in pixel]
    return Image(width, height, channels, depth, samples)


def textured(width, height, channels=3):
    """The scene with noise added, so that its detail uses any number of bytes."""
    image, grain = scene(width, height, channels), noise(width, height, channels)
    image.samples = [min(max(a + (b - 128) // 4, 0), 255) for a, b in zip(image.samples, grain.samples)]
    return image


def noise(width, height, channels=3, seed=1):
    """Uniform 8-bit noise, which no codec compresses."""
    state, samples = seed, []
    for _ in range(width * height * channels):
        state = (state * 1664525 + 1013904223) % 2 ** 32
        samples.append(state >> 24)
    return Image(width, height, channels, 8, samples)


def waves(width, height):
    """Smooth waves in all colours, without any detail."""
    samples = []
    for y in range(height):
        for x in range(width):
            grey = 128 + 30 * math.sin((x + 2 * y) / 60)
            samples += [round(grey + 50 * math.sin(x / 30 + k) * math.cos(y / 25 - k)) for k in range(3)]
    return Image(width, height, 3, 8, samples)


def glow(width, height):
    """A round grey light, without any detail."""
    radius = 50 * width / 192
    return Image(width, height, 1, 8, [round(255 * math.exp(-((x - width / 2) ** 2 + (y - height / 2) ** 2) / radius ** 2))
                                       for y in range(height) for x in range(width)])


def hills(width, height):
    """Random colours at 14 x 10 points, and smooth transitions between them."""
    points, samples = noise(14, 10, seed=5), []

    def ease(part):
        return (1 - math.cos(math.pi * part)) / 2

    def mix(left, right, part):
        return left + (right - left) * ease(part)

    for y in range(height):
        row, down = divmod(9 * y / height, 1)
        above, below = points.row(int(row)), points.row(int(row) + 1)
        for x in range(width):
            column, across = divmod(13 * x / width, 1)
            for i in range(3 * int(column), 3 * int(column) + 3):
                samples.append(round(mix(mix(above[i], above[i + 3], across), mix(below[i], below[i + 3], across), down)))
    return Image(width, height, 3, 8, samples)


def dots_in_the_dark(width, height):
    """Small bright dots, far apart, on nearly black noise."""
    image = noise(width, height)
    image.samples = [8 + b // 32 for b in image.samples]
    places = noise(width * height // 400, 3, channels=1, seed=7)
    for place_x, place_y, grey in zip(places.row(0), places.row(1), places.row(2)):
        left, top = (width - 4) * place_x // 256, (height - 4) * place_y // 256
        for y in range(top, top + 4):
            for x in range(left, left + 4):
                at = (y * width + x) * 3
                image.samples[at:at + 3] = [160 + grey // 3] * 3
    return image


def faint_and_strong(width, height):
    """Blocks of random greys, with low contrast in the left half and high contrast in the right half."""
    block = 8
    greys = noise((width + block - 1) // block, (height + block - 1) // block, channels=1)
    samples = []
    for y in range(height):
        row = greys.row(y // block)
        for x in range(width):
            samples += [128 + (row[x // block] - 128) // (12 if x < width // 2 else 1)] * 3
    return Image(width, height, 3, 8, samples)


def checkerboard(width, height, side):
    return Image(width, height, 1, 8, [255 * ((x // side + y // side) % 2) for y in range(height) for x in range(width)])


def sawtooth(width, height):
    """Slanted ramps with hard edges."""
    return Image(width, height, 1, 8, [(7 * x + 3 * y) % 256 for y in range(height) for x in range(width)])


def document(width, height):
    """Lines of black strokes on white, as in a page of text."""
    strokes = noise(width, height, channels=1, seed=9)
    samples = [0 if y % 8 in (2, 3, 4, 5) and strokes.samples[y // 8 * width + x // 2] < 110 else 255
               for y in range(height) for x in range(width)]
    return Image(width, height, 1, 8, samples)


def blocks(image):
    """The image with blocks of 8 x 8 pixels of one colour each, which jpeg_bytes stores exactly."""
    size = image.channels
    samples = [image.row(y // 8 * 8)[x // 8 * 8 * size + c]
               for y in range(image.height) for x in range(image.width) for c in range(size)]
    return Image(image.width, image.height, size, image.depth, samples)


def flat(width, height, colour, depth=8):
    return Image(width, height, len(colour), depth, list(colour) * (width * height))


# ---- PNG ------------------------------------------------------------------------------------------

PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"
PNG_COLOUR_TYPES = {1: 0, 2: 4, 3: 2, 4: 6}


def png_chunk(kind, content):
    return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))


def png_header(width, height, depth, colour_type, interlace=0):
    return png_chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, depth, colour_type, 0, 0, interlace))


def jpeg_parts(data):
    """The contents of the segments of metadata of a JPEG by their identifiers, those of a profile joined."""
    parts, at = {}, 2
    while data[at + 1] != 0xDA:
        length = struct.unpack_from(">H", data, at + 2)[0]
        content, at = data[at + 4:at + 2 + length], at + 2 + length
        for identifier, skip in ((b"Exif\0\0", 6), (b"http://ns.adobe.com/xap/1.0/\0", 29), (b"ICC_PROFILE\0", 14)):
            if content.startswith(identifier):
                parts[identifier] = parts.get(identifier, b"") + content[skip:]
    return parts


def metadata_of(data):
    """Profile, EXIF and XMP of a PNG, JPEG or TIFF; None for what it lacks, and for the EXIF of a TIFF, which is the
    file itself."""
    if data[:2] == b"\xff\xd8":
        parts = jpeg_parts(data)
        return parts.get(b"ICC_PROFILE\0"), parts.get(b"Exif\0\0"), parts.get(b"http://ns.adobe.com/xap/1.0/\0")
    if data[:4] in (b"II*\0", b"MM\0*"):
        return tiff_block(data, 34675), None, tiff_block(data, 700)
    parts = png_parts(data)
    icc, xmp = parts.get(b"iCCP"), parts.get(b"iTXt")
    return (icc and zlib.decompress(icc[icc.index(b"\0") + 2:]), parts.get(b"eXIf"),
            xmp and xmp[len(b"XML:com.adobe.xmp") + 5:])


def tiff_block(data, tag):
    """The bytes of a field of the first directory of a TIFF, or None."""
    order = "<" if data[:2] == b"II" else ">"
    at = struct.unpack_from(order + "I", data, 4)[0]
    for i in range(struct.unpack_from(order + "H", data, at)[0]):
        found, kind, count, value = struct.unpack_from(order + "HHII", data, at + 2 + 12 * i)
        if found == tag:
            assert kind in (1, 7) and count > 4
            return data[value:value + count]
    return None


def big_endian(samples, depth):
    return bytes(samples) if depth == 8 else struct.pack(f">{len(samples)}H", *samples)


def png_bytes(image, chunks=()):
    """`chunks` are pairs of a name and contents that stand before the pixels."""
    rows = b"".join(b"\0" + big_endian(image.row(y), image.depth) for y in range(image.height))
    header = png_header(image.width, image.height, image.depth, PNG_COLOUR_TYPES[image.channels])
    header += b"".join(png_chunk(kind, content) for kind, content in chunks)
    return PNG_SIGNATURE + header + png_chunk(b"IDAT", zlib.compress(rows)) + png_chunk(b"IEND", b"")


def png_icc(profile):
    """The chunk of a colour profile."""
    return b"iCCP", b"profile\0\0" + zlib.compress(profile)


def png_xmp(text, packed=False):
    return b"iTXt", b"XML:com.adobe.xmp\0" + bytes((packed, 0)) + b"\0\0" + (zlib.compress(text) if packed else text)


def png_palette_bytes(width, height, palette, indices):
    """A PNG of palette indices.  Palette entries are (r, g, b) or (r, g, b, a)."""
    rows = b"".join(b"\0" + bytes(indices[y * width:(y + 1) * width]) for y in range(height))
    chunks = png_header(width, height, 8, 3) + png_chunk(b"PLTE", bytes(c for entry in palette for c in entry[:3]))
    if len(palette[0]) == 4:
        chunks += png_chunk(b"tRNS", bytes(entry[3] for entry in palette))
    return PNG_SIGNATURE + chunks + png_chunk(b"IDAT", zlib.compress(rows)) + png_chunk(b"IEND", b"")


def png_parts(data):
    assert data[:8] == PNG_SIGNATURE, "not a PNG"
    at, parts = 8, {}
    while at < len(data):
        length, kind = struct.unpack_from(">I4s", data, at)
        content = data[at + 8:at + 8 + length]
        assert zlib.crc32(kind + content) == struct.unpack_from(">I", data, at + 8 + length)[0], "wrong checksum"
        parts[kind] = parts.get(kind, b"") + content
        at += length + 12
    return parts


def paeth(left, up, corner):
    estimate = left + up - corner
    distances = [(abs(estimate - value), order, value) for order, value in enumerate((left, up, corner))]
    return min(distances)[2]


def unfilter(kind, line, above, step):
    for i in range(len(line)):
        left = line[i - step] if i >= step else 0
        corner = above[i - step] if i >= step else 0
        guess = (0, left, above[i], (left + above[i]) // 2, paeth(left, above[i], corner))[kind]
        line[i] = (line[i] + guess) & 255
    return line


def read_png(data):
    """Reads a PNG without palette and interlacing."""
    parts = png_parts(data)
    width, height, depth, colour_type, _, _, interlace = struct.unpack(">IIBBBBB", parts[b"IHDR"])
    channels = {kind: count for count, kind in PNG_COLOUR_TYPES.items()}[colour_type]
    assert depth in (8, 16) and interlace == 0 and b"IEND" in parts
    raw = zlib.decompress(parts[b"IDAT"])
    step, size = channels * depth // 8, width * channels * depth // 8
    above, rows = bytearray(size), []
    for y in range(height):
        begin = y * (size + 1)
        above = unfilter(raw[begin], bytearray(raw[begin + 1:begin + 1 + size]), above, step)
        rows.append(above)
    samples = array.array("B" if depth == 8 else "H", b"".join(rows))
    if depth == 16 and sys.byteorder == "little":
        samples.byteswap()
    return Image(width, height, channels, depth, samples.tolist())


# ---- PNM, TIFF, OpenEXR ---------------------------------------------------------------------------

def pnm_bytes(image):
    kind = {1: "P5", 3: "P6"}[image.channels]
    header = f"{kind}\n{image.width} {image.height}\n{image.peak}\n"
    return header.encode() + big_endian(image.samples, image.depth)


def read_pnm(data):
    kind, size, peak, samples = data.split(b"\n", 3)
    width, height = map(int, size.split())
    depth = 8 if int(peak) == 255 else 16
    values = samples if depth == 8 else struct.unpack(f">{len(samples) // 2}H", samples)
    return Image(width, height, {b"P5": 1, b"P6": 3}[kind], depth, list(values))


TIFF_SHORT, TIFF_LONG, TIFF_UNDEFINED = 3, 4, 7


def tiff_bytes(image, extra_samples=(), photometric=None, orientation=1, blocks=()):
    """An uncompressed big-endian TIFF with one strip.  `extra_samples`: 1 premultiplied alpha, 2 straight alpha, 0 other.
    `blocks` are pairs of a tag above 338 and bytes."""
    pixels = big_endian(image.samples, image.depth)
    count = image.channels
    if photometric is None:
        photometric = 2 if count >= 3 else 1
    tail = struct.pack(f">{count}H", *[image.depth] * count)
    tail_at = 8 + len(pixels)
    bits = (258, TIFF_SHORT, count, tail_at) if count > 2 else (258, TIFF_SHORT, count, tail)
    entries = [(256, TIFF_LONG, 1, image.width), (257, TIFF_LONG, 1, image.height), bits,
               (259, TIFF_SHORT, 1, 1), (262, TIFF_SHORT, 1, photometric), (273, TIFF_LONG, 1, 8),
               (274, TIFF_SHORT, 1, orientation), (277, TIFF_SHORT, 1, count), (278, TIFF_LONG, 1, image.height),
               (279, TIFF_LONG, 1, len(pixels))]
    if extra_samples:
        entries.append((338, TIFF_SHORT, len(extra_samples), struct.pack(f">{len(extra_samples)}H", *extra_samples)))
    for tag, data in blocks:
        entries.append((tag, TIFF_UNDEFINED, len(data), struct.pack(">I", tail_at + len(tail))))
        tail += data + bytes(len(data) % 2)
    directory = struct.pack(">H", len(entries)) + b"".join(map(tiff_entry, entries)) + struct.pack(">I", 0)
    return struct.pack(">2sHI", b"MM", 42, tail_at + len(tail)) + pixels + tail + directory


def tiff_entry(entry):
    tag, kind, count, value = entry
    if not isinstance(value, bytes):
        value = struct.pack(">H" if kind == TIFF_SHORT and count == 1 else ">I", value)
    return struct.pack(">HHI", tag, kind, count) + value.ljust(4, b"\0")


def exr_bytes(width, height, planes, data_window=None, primaries=None):
    """An uncompressed OpenEXR of floats.  `planes` maps the name of a channel to its samples, row by row.  `primaries` are
    x and y of white, red, green and blue."""
    window = struct.pack("<4i", *(data_window or (0, 0, width - 1, height - 1)))
    names = sorted(planes)
    channels = b"".join(name.encode() + b"\0" + struct.pack("<iB3xii", 2, 0, 1, 1) for name in names) + b"\0"
    attributes = [("channels", "chlist", channels), ("compression", "compression", b"\0"),
                  ("dataWindow", "box2i", window), ("displayWindow", "box2i", window), ("lineOrder", "lineOrder", b"\0"),
                  ("pixelAspectRatio", "float", struct.pack("<f", 1)), ("screenWindowCenter", "v2f", bytes(8)),
                  ("screenWindowWidth", "float", struct.pack("<f", 1))]
    if primaries:
        white, *colours = primaries
        values = [value for xy in (*colours, white) for value in xy]
        attributes.append(("chromaticities", "chromaticities", struct.pack("<8f", *values)))
    header = struct.pack("<II", 20000630, 2)
    for name, kind, value in attributes:
        header += name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<I", len(value)) + value
    header += b"\0"
    line_size = 8 + 4 * width * len(names)
    offsets = struct.pack(f"<{height}Q", *(len(header) + 8 * height + y * line_size for y in range(height)))
    lines = b"".join(exr_line(width, y, [planes[name] for name in names]) for y in range(height))
    return header + offsets + lines


def exr_line(width, y, planes):
    values = [value for plane in planes for value in plane[y * width:(y + 1) * width]]
    return struct.pack("<iI", y, 4 * len(values)) + struct.pack(f"<{len(values)}f", *values)


# ---- JPEG and WebP --------------------------------------------------------------------------------

def jpeg_segment(marker, content):
    return struct.pack(">BBH", 0xFF, marker, len(content) + 2) + content


def jpeg_exif(exif):
    return 0xE1, b"Exif\0\0" + exif


def jpeg_xmp(text):
    return 0xE1, b"http://ns.adobe.com/xap/1.0/\0" + text


def jpeg_icc(profile, part_size=65519):
    parts = [profile[at:at + part_size] for at in range(0, len(profile), part_size)]
    return [(0xE2, b"ICC_PROFILE\0" + bytes((i + 1, len(parts))) + part) for i, part in enumerate(parts)]


def jpeg_bytes(image, segments=()):
    """A JPEG of blocks of 8 x 8 pixels, each of one colour: that of its top left pixel.  It stores RGB (and inks, four
    channels) as they are, so that decoding is exact.  `segments` are pairs of a marker and contents."""
    count = image.channels
    names = b"RGB" if count == 3 else b"CMYK"[:count]  # components of these names are not YCbCr
    frame = struct.pack(">BHHB", 8, image.height, image.width, count) + b"".join(bytes((n, 0x11, 0)) for n in names)
    scan = bytes([count]) + b"".join(bytes((n, 0)) for n in names) + bytes((0, 63, 0))
    # Differences of DC have 0 to 11 bits, all with codes of 4 bits; the only code of AC ends the block.
    dc = bytes([0x00] + [0, 0, 0, 12] + [0] * 12) + bytes(range(12))
    ac = bytes([0x10] + [1] + [0] * 15) + b"\0"
    bits, previous = "", [0] * count
    for y in range(0, image.height, 8):
        for x in range(0, image.width, 8):
            for c in range(count):
                value = 8 * (image.row(y)[x * count + c] - 128)
                difference, previous[c] = value - previous[c], value
                size = abs(difference).bit_length()
                bits += f"{size:04b}" + (f"{difference if difference > 0 else difference + (1 << size) - 1:0{size}b}"
                                         if size else "") + "0"
    bits += "1" * (-len(bits) % 8)
    data = bytes(int(bits[i:i + 8], 2) for i in range(0, len(bits), 8)).replace(b"\xff", b"\xff\0")
    return (b"\xff\xd8" + b"".join(jpeg_segment(*segment) for segment in segments) +
            jpeg_segment(0xDB, b"\0" + b"\1" * 64) + jpeg_segment(0xC0, frame) + jpeg_segment(0xC4, dc) +
            jpeg_segment(0xC4, ac) + jpeg_segment(0xDA, scan) + data + b"\xff\xd9")


def webp_lossless(image):
    """The bitstream of an opaque WebP of 8-bit RGB that codes each sample with 8 bits."""
    fields = [(0x2F, 8), (image.width - 1, 14), (image.height - 1, 14), (0, 1), (0, 3)]
    fields += [(0, 1), (0, 1), (0, 1)]  # no transform, no colour cache, no further groups of codes
    for symbols in (280, 256, 256):  # green, red, blue: 256 codes of 8 bits, then unused ones
        fields += [(0, 1), (15 - 4, 4)]  # code lengths are coded; 15 lengths of those codes follow
        order = [17, 18, 0, 1, 2, 3, 4, 5, 16, 6, 7, 8, 9, 10, 11]
        fields += [(1 if length in (0, 8) else 0, 3) for length in order]
        fields += [(0, 1)] + [(1, 1)] * 256 + [(0, 1)] * (symbols - 256)  # "0" is length 0, "1" length 8
    fields += [(1, 1), (0, 1), (1, 1), (255, 8)]  # alpha: the only symbol is 255
    fields += [(1, 1), (0, 1), (0, 1), (0, 1)]  # distance: the only symbol is 0
    for at in range(0, len(image.samples), 3):
        red, green, blue = image.samples[at:at + 3]
        fields += [(int(f"{value:08b}"[::-1], 2), 8) for value in (green, red, blue)]
    bits = "".join(f"{value:0{size}b}"[::-1] for value, size in fields)
    bits += "0" * (-len(bits) % 8)
    return bytes(int(bits[i:i + 8][::-1], 2) for i in range(0, len(bits), 8))


def webp_chunk(name, content):
    return struct.pack("<4sI", name, len(content)) + content + bytes(len(content) % 2)


WEBP_FLAGS = {b"ICCP": 0x20, b"EXIF": 0x08, b"XMP ": 0x04}


def webp_bytes(image, chunks=()):
    """`chunks` are pairs of a name and contents."""
    flags = sum(WEBP_FLAGS[name] for name, _ in chunks)
    size = struct.pack("<I", image.width - 1)[:3] + struct.pack("<I", image.height - 1)[:3]
    parts = [webp_chunk(b"VP8X", bytes((flags, 0, 0, 0)) + size)] if chunks else []
    parts += [webp_chunk(name, content) for name, content in chunks if name == b"ICCP"]
    parts += [webp_chunk(b"VP8L", webp_lossless(image))]
    parts += [webp_chunk(name, content) for name, content in chunks if name != b"ICCP"]
    body = b"WEBP" + b"".join(parts)
    return struct.pack("<4sI", b"RIFF", len(body)) + body


# ---- AVIF -----------------------------------------------------------------------------------------

AVIF_IMAGE = (8, 8, (200, 100, 50))  # size and colour of the image in the bitstream of AV1 below, which is lossless RGB
AV1 = bytes.fromhex("12000a083808bf61020200903212100000000ffa431b78c7a8f5464ca7b32495")


def isobmff_box(kind, content, version=None):
    head = b"" if version is None else struct.pack(">I", version << 24)
    return struct.pack(">I4s", 8 + len(head) + len(content), kind) + head + content


def avif_bytes(colours=(2, 2), profile=None, items=()):
    """An AVIF of AVIF_IMAGE.  `colours` are code points.  `items` are pairs of the entry of an item of metadata without
    its number (its type and name) and its bytes."""
    width, height, _ = AVIF_IMAGE
    parts = [(b"av01\0", AV1), *items]
    properties = isobmff_box(b"ispe", struct.pack(">II", width, height), 0)
    properties += isobmff_box(b"pixi", bytes((3, 8, 8, 8)), 0) + isobmff_box(b"av1C", bytes.fromhex("81200000"))
    properties += isobmff_box(b"colr", b"nclx" + struct.pack(">HHHB", *colours, 0, 128))
    properties += isobmff_box(b"colr", b"prof" + profile) if profile is not None else b""
    indices = [1, 2, 0x83, 4] + ([5] if profile is not None else [])
    entries = b"".join(isobmff_box(b"infe", struct.pack(">HH", i + 1, 0) + name, 2) for i, (name, _) in enumerate(parts))
    start = isobmff_box(b"ftyp", b"avif" + bytes(4) + b"avifmif1")
    for offset in (0, None):  # the places of the items follow from the size of the box that holds them
        at, places = (len(start) + len(meta) + 8) if offset is None else 0, b""
        for i, (_, content) in enumerate(parts):
            places += struct.pack(">HHHII", i + 1, 0, 1, at, len(content))
            at += len(content)
        meta = isobmff_box(b"meta", b"".join((
            isobmff_box(b"hdlr", bytes(4) + b"pict" + bytes(13), 0), isobmff_box(b"pitm", struct.pack(">H", 1), 0),
            isobmff_box(b"iloc", struct.pack(">HH", 0x4400, len(parts)) + places, 0),
            isobmff_box(b"iinf", struct.pack(">H", len(parts)) + entries, 0),
            isobmff_box(b"iprp", isobmff_box(b"ipco", properties) + isobmff_box(
                b"ipma", struct.pack(">IHB", 1, 1, len(indices)) + bytes(indices), 0)),
            isobmff_box(b"iref", b"".join(isobmff_box(b"cdsc", struct.pack(">HHH", i + 2, 1, 1))
                                          for i in range(len(items))), 0))), 0)
    return start + meta + isobmff_box(b"mdat", b"".join(content for _, content in parts))


def avif_exif(exif):
    return b"Exif\0", bytes(4) + exif


def avif_xmp(text):
    return b"mime\0application/rdf+xml\0", text


# ---- Colours --------------------------------------------------------------------------------------

def srgb_to_linear(value):
    return value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4
