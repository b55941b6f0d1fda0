"""PNM: PBM, PGM, PPM, PAM and PFM, of text and bytes, with comments, any maximum and both orders of bytes."""

import numpy

from picture import HEIGHT, WIDTH, Sample, picture, scaled

REFUSED = r", P1 without blanks|, P7|scale -2.5"


def text(values):
    return b"\n".join(b" ".join(str(int(v)).encode() for v in row.reshape(-1)) for row in values) + b"\n"


def binary(values, peak):
    return values.astype("u1" if peak < 256 else ">u2").tobytes()


def bits(values):
    return b"".join(numpy.packbits(row.reshape(-1).astype(bool)).tobytes() for row in values)


def by_hand():
    ink = 1 - picture(1, 1)  # 1 is black
    yield "P1", ".pbm", f"P1\n{WIDTH} {HEIGHT}\n".encode() + text(ink), scaled(1 - ink, 1)
    dense = b"\n".join("".join(str(int(v)) for v in row.reshape(-1)).encode() for row in ink)
    yield "P1 without blanks", ".pbm", f"P1\n{WIDTH} {HEIGHT}\n".encode() + dense + b"\n", scaled(1 - ink, 1)
    yield "P4", ".pbm", f"P4\n{WIDTH} {HEIGHT}\n".encode() + bits(ink), scaled(1 - ink, 1)
    for channels, plain, raw, suffix in ((1, "P2", "P5", ".pgm"), (3, "P3", "P6", ".ppm")):
        for peak in (1, 15, 100, 255, 256, 1023, 4095, 65535):
            values = picture(channels, peak)
            head = f"{WIDTH} {HEIGHT}\n{peak}\n".encode()
            yield f"{plain}, maximum {peak}", suffix, plain.encode() + b"\n" + head + text(values), scaled(values, peak)
            yield f"{raw}, maximum {peak}", suffix, raw.encode() + b"\n" + head + binary(values, peak), scaled(
                values, peak
            )
        values = picture(channels)
        head = f"# made by hand\n{WIDTH} # width\n# and\n{HEIGHT}\n255\n".encode()
        yield f"{raw} with comments", suffix, raw.encode() + b"\n" + head + binary(values, 255), scaled(values)
        yield f"{plain} with comments", suffix, plain.encode() + b"\n" + head + text(values), scaled(values)
        yield f"{raw}, one line of header", suffix, f"{raw} {WIDTH} {HEIGHT} 255\n".encode() + binary(
            values, 255
        ), scaled(values)
        yield f"{raw}, suffix .pnm", ".pnm", f"{raw} {WIDTH} {HEIGHT} 255\n".encode() + binary(values, 255), scaled(
            values
        )
    for name, channels, peak in (
        ("BLACKANDWHITE", 1, 1),
        ("GRAYSCALE", 1, 255),
        ("GRAYSCALE", 1, 65535),
        ("GRAYSCALE_ALPHA", 2, 255),
        ("RGB", 3, 255),
        ("RGB", 3, 1023),
        ("RGB_ALPHA", 4, 255),
        ("RGB_ALPHA", 4, 65535),
    ):
        values = picture(channels, peak)
        head = (
            f"P7\nWIDTH {WIDTH}\nHEIGHT {HEIGHT}\nDEPTH {channels}\nMAXVAL {peak}\nTUPLTYPE {name}\nENDHDR\n".encode()
        )
        yield f"P7, {name}, maximum {peak}", ".pam", head + binary(values, peak), scaled(values, peak)
    for channels, kind in ((1, "Pf"), (3, "PF")):
        values = scaled(picture(channels, 60000), 60000)
        for order, scale in (("<f4", -1), (">f4", 1), ("<f4", -2.5)):
            data = values[::-1].astype(order).tobytes()
            yield f"{kind}, scale {scale}", ".pfm", f"{kind}\n{WIDTH} {HEIGHT}\n{scale}\n".encode() + data, values


def samples():
    for variant, suffix, data, expected in by_hand():
        yield Sample("PNM", variant, "bytes", suffix, data, expected)
