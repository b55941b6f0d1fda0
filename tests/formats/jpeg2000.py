"""JPEG 2000 by OpenJPEG (imagecodecs) and Pillow: depths, channels, alpha, colour spaces, boxes and code streams."""

import io

import numpy

from picture import Sample, indexed, picture, scaled

REFUSED = r"unknown alpha"


def box(kind, data):
    return (8 + len(data)).to_bytes(4, "big") + kind + data


def boxes(data):
    at, found = 0, []
    while at < len(data):
        size = int.from_bytes(data[at : at + 4], "big") or len(data) - at
        found.append((data[at + 4 : at + 8], data[at + 8 : at + size]))
        at += size
    return found


def with_header(data, change):
    """A JP2 whose boxes of the header `change`, which gets and returns a list, has changed."""
    return b"".join(
        box(kind, b"".join(box(*inner) for inner in change(boxes(content))) if kind == b"jp2h" else content)
        for kind, content in boxes(data)
    )


def channel_definition(*entries):
    return b"cdef", len(entries).to_bytes(2, "big") + b"".join(v.to_bytes(2, "big") for entry in entries for v in entry)


def with_alpha_kind(data, channels, kind):
    """States that the last channel is straight (1) or premultiplied (2) opacity, or nothing known (65535)."""
    entries = [(c, 0, c + 1) for c in range(channels - 1)] + [(channels - 1, kind, 0 if kind in (1, 2) else 65535)]
    return with_header(data, lambda inner: [b for b in inner if b[0] != b"cdef"] + [channel_definition(*entries)])


def with_palette(data, palette):
    """An image of indices as one of colours."""
    count, columns = palette.shape
    pclr = count.to_bytes(2, "big") + bytes((columns,)) + bytes((7,)) * columns + palette.astype("u1").tobytes()
    cmap = b"".join(bytes((0, 0, 1, c)) for c in range(columns))

    def change(inner):
        out = []
        for kind, content in inner:
            if kind == b"colr":
                out += [(b"pclr", pclr), (b"cmap", cmap)]
                content = content[:3] + (16).to_bytes(4, "big")
            out.append((kind, content))
        return out

    return with_header(data, change)


def samples():
    import imagecodecs
    from PIL import Image

    for codec in ("jp2", "j2k"):
        for bits in (8, 12, 16):
            peak = 2**bits - 1
            for channels in (1, 2, 3, 4):
                pixels = picture(channels, peak)
                stored = pixels.astype("u1" if bits == 8 else "u2")
                data = imagecodecs.jpeg2k_encode(
                    stored[..., 0] if channels == 1 else stored,
                    codecformat=codec,
                    bitspersample=bits,
                    reversible=True,
                    level=0,
                )
                name = f"{codec}, {bits} bits, {channels} channels"
                # A code stream alone does not say what its channels mean.
                yield Sample("JPEG 2000", name, "OpenJPEG", "." + codec, data, scaled(pixels, peak))
                if codec == "jp2" and channels in (2, 4):
                    for kind, label in {1: "straight", 2: "premultiplied", 65535: "unknown"}.items():
                        content, shown = stored, scaled(pixels, peak)
                        if kind == 2:
                            content = stored.astype(float)
                            content[..., :-1] *= content[..., -1:] / peak
                            content = numpy.rint(content).astype(stored.dtype)
                        if kind == 65535:
                            shown = shown[..., :-1]
                        data = imagecodecs.jpeg2k_encode(
                            content, codecformat=codec, bitspersample=bits, reversible=True, level=0
                        )
                        yield Sample(
                            "JPEG 2000",
                            f"{name}, {label} alpha",
                            "OpenJPEG and bytes",
                            ".jp2",
                            with_alpha_kind(data, channels, kind),
                            shown,
                        )
    for mode, channels in (("L", 1), ("LA", 2), ("RGB", 3), ("RGBA", 4)):
        for suffix in (".jp2", ".j2k"):
            out = io.BytesIO()
            pixels = picture(channels)
            Image.fromarray(pixels.astype("u1").squeeze(), mode).save(
                out, "JPEG2000", irreversible=False, no_jp2=suffix == ".j2k"
            )
            yield Sample("JPEG 2000", f"{suffix[1:]}, {mode}", "Pillow", suffix, out.getvalue(), scaled(pixels))
    out = io.BytesIO()
    Image.fromarray(picture(3).astype("u1")).save(
        out, "JPEG2000", irreversible=False, tile_size=(16, 16), num_resolutions=2
    )
    yield Sample("JPEG 2000", "jp2, RGB, tiles", "Pillow", ".jp2", out.getvalue(), scaled(picture(3)))
    out = io.BytesIO()
    Image.fromarray(picture(3).astype("u1")).save(
        out, "JPEG2000", irreversible=False, offset=(5, 3), tile_offset=(2, 1), tile_size=(64, 64)
    )
    yield Sample("JPEG 2000", "jp2, RGB, offset", "Pillow", ".jp2", out.getvalue(), scaled(picture(3)))
    out = io.BytesIO()
    Image.fromarray(picture(3).astype("u1")).save(
        out, "JPEG2000", irreversible=True, quality_mode="dB", quality_layers=[60]
    )
    yield Sample("JPEG 2000", "jp2, RGB, irreversible", "Pillow", ".jp2", out.getvalue(), scaled(picture(3)), 3 / 255)
    palette, indices = indexed(64)
    data = imagecodecs.jpeg2k_encode(indices.astype("u1"), codecformat="jp2", reversible=True, level=0)
    yield Sample(
        "JPEG 2000", "jp2, palette", "OpenJPEG and bytes", ".jp2", with_palette(data, palette), scaled(palette[indices])
    )
    rgb = picture(3).astype(float)
    luma = rgb @ [0.299, 0.587, 0.114]
    ycc = numpy.rint(
        numpy.stack([luma, (rgb[..., 2] - luma) / 1.772 + 128, (rgb[..., 0] - luma) / 1.402 + 128], -1)
    ).astype("u1")
    data = imagecodecs.jpeg2k_encode(ycc, codecformat="jp2", reversible=True, level=0, mct=False)
    sycc = with_header(
        data, lambda inner: [(k, c[:3] + (18).to_bytes(4, "big") if k == b"colr" else c) for k, c in inner]
    )
    yield Sample("JPEG 2000", "jp2, sYCC", "OpenJPEG and bytes", ".jp2", sycc, rgb / 255, 3 / 255)
    for bits in (8, 16):
        peak = 2 ** (bits - 1)
        pixels = picture(1, 2 * peak - 1)
        stored = (pixels - peak).astype(f"i{bits // 8}")
        data = imagecodecs.jpeg2k_encode(stored[..., 0], codecformat="jp2", reversible=True, level=0)
        yield Sample("JPEG 2000", f"jp2, signed {bits} bits", "OpenJPEG", ".jp2", data, scaled(pixels, 2 * peak - 1))
