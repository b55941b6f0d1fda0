"""gscl.encode: pictures, targets, settings, metadata, report."""

import copy
import io
import math
import pickle
import subprocess

import numpy
import pytest
from PIL import Image, ImageCms, PngImagePlugin

import gscl
from conftest import make_picture, psnr
from gscl._binding import ffi, lib
from gscl._names import PRESETS
from profiles import DISPLAY_P3, icc_rgb, srgb_of


def encode(picture, **options):
    return gscl.encode(picture, **{"effort": 0, "bytes": 400, **options})


def test_bytes(picture, data):
    assert isinstance(data, bytes) and 100 < len(data) <= 400
    assert psnr(picture, gscl.decode(data)) > 30


def test_bpp(picture):
    encoded = gscl.encode(picture, bpp=0.4, effort=0)
    assert len(encoded) == encoded.report.bytes <= 0.4 * 96 * 64 / 8


def test_psnr(picture):
    encoded = gscl.encode(picture, psnr=30, effort=0)
    assert encoded.report.psnr >= 30
    assert psnr(picture, gscl.decode(encoded)) == pytest.approx(encoded.report.psnr, abs=0.01)


def test_quality(picture):
    report = gscl.encode(picture, quality=21, effort=0).report
    assert 6 <= report.ssimulacra2 < 20 and report.tune == "visual"
    assert gscl.encode(picture, quality=40, effort=0) == gscl.encode(picture, ssimulacra2=40, effort=0)
    with pytest.raises(gscl.InvalidArgumentError, match="101 of quality is not in 0..100"):
        gscl.encode(picture, quality=101)


def test_preset(picture):
    assert gscl.encode(picture, preset="tiny") == gscl.encode(picture, bytes=250, effort=3)
    assert gscl.encode(picture, preset="preview") == gscl.encode(picture, bytes=256, effort=3)
    large = make_picture(240, 160)
    assert gscl.encode(large, preset="preview", effort=0) == gscl.encode(large, bpp=0.06, effort=0)
    assert gscl.encode(picture, preset="small") == gscl.encode(picture)
    assert gscl.encode(picture, preset="good", effort=0) == gscl.encode(picture, quality=50, effort=0)
    with pytest.raises(gscl.ConflictError, match="more than one target: preset, bytes"):
        gscl.encode(picture, preset="small", bytes=300)
    with pytest.raises(gscl.InvalidArgumentError, match="preset: 'large': expected one of tiny, preview, small, good"):
        gscl.encode(picture, preset="large")


def test_words_of_presets_are_those_of_the_library():
    assert {ffi.string(lib.gscl_preset_name(number)).decode(): number for number in range(4)} == PRESETS
    assert not lib.gscl_preset_name(4)


def test_ssimulacra2(picture):
    encoded = gscl.encode(picture, ssimulacra2=20, effort=0)
    assert 20 <= encoded.report.ssimulacra2 < 40 and encoded.report.tune == "visual"
    assert gscl.compare(picture, gscl.decode(encoded)).ssimulacra2 == pytest.approx(encoded.report.ssimulacra2, abs=0.01)
    assert math.isnan(gscl.encode(picture, psnr=25, effort=0).report.ssimulacra2)


def test_splats(picture):
    encoded = gscl.encode(picture, splats=20, effort=0)
    assert encoded.report.splats <= 20 and gscl.info(encoded).splats == encoded.report.splats


def test_default_target(picture):
    assert len(gscl.encode(picture, effort=0)) <= 256


def test_report(picture):
    report = encode(picture, trace=True).report
    assert report.blend == "normalized"
    assert report.tune == "psnr"  # of a small file
    assert {row.effect: row.reason for row in report.effects}["chroma"] == "content"
    assert any(stage.name == "write" and stage.count == 1 for stage in report.stages)
    assert report.trace[-1].splats == report.splats
    assert report.seconds > 0 and report.trials >= 1


def test_encoded_is_the_file(data, tmp_path):
    """Whatever takes the bytes of a file takes what encode returned."""
    path = tmp_path / "picture.gscl"
    assert path.write_bytes(data) == len(data) == data.report.bytes
    assert path.read_bytes() == data and type(data[:10]) is bytes
    assert numpy.array_equal(gscl.decode(data), gscl.decode(path))
    assert gscl.info(data) == gscl.info(path) and gscl.certain_splats(data) == gscl.certain_splats(path)
    assert numpy.array_equal(gscl.splats(data), gscl.splats(path)) and gscl.metadata(data) == {}
    decoder = gscl.Decoder()
    decoder.add_bytes(data)
    assert decoder.splats == data.report.splats


def pickled(protocol):
    return lambda value: pickle.loads(pickle.dumps(value, protocol))


COPIES = [copy.copy, copy.deepcopy, *map(pickled, range(pickle.HIGHEST_PROTOCOL + 1))]


@pytest.mark.parametrize("options", [{}, {"packets": 120}], ids=["file", "packets"])
@pytest.mark.parametrize("make_copy", COPIES)
def test_copies_keep_the_report(picture, make_copy, options):
    encoded = encode(picture, trace=True, **options)
    found = make_copy(encoded)
    assert type(found) is type(encoded) and found == encoded
    assert found.report == encoded.report and hash(found.report) == hash(encoded.report)
    assert found.report.trace and found.report.trace == encoded.report.trace
    assert not options or found.packets == encoded.packets


@pytest.mark.parametrize("make_copy", COPIES)
def test_copies_of_reports_are_equal(picture, data, make_copy):
    """NaN, an unknown figure, does not make them differ."""
    tiny = gscl.compare(picture[:4, :4], 255 - picture[:4, :4])
    assert math.isnan(data.report.ssimulacra2) and any(math.isnan(row.gain_db) for row in data.report.effects)
    assert math.isnan(tiny.ssimulacra2)
    (device, *_) = gscl.devices()
    for record in data.report, *data.report.effects, *data.report.stages, gscl.info(data), tiny, device:
        found = make_copy(record)
        assert found == record and hash(found) == hash(record) and not found != record
    devices = make_copy(gscl.devices())
    assert devices == gscl.devices() and devices.missing == gscl.devices().missing


def test_reports_differ(picture, data):
    other = encode(picture, seed=2)
    assert other.report != data.report and other != data
    assert gscl.info(other) != gscl.info(data) and gscl.info(data) != data.report and data.report != 7
    assert len({gscl.info(data), gscl.info(bytes(data)), gscl.info(other)}) == 2


def test_texts_are_short(data, picture):
    """One line each: without rows, without figures that are unknown, and without the bytes."""
    report = data.report
    expected = f"EncodeReport(bytes={len(data)}, splats={report.splats}, psnr={report.psnr:.6g}, seconds={report.seconds:.6g}, "
    assert repr(report) == expected + f"trials={report.trials}, blend='normalized', tune='psnr')"
    assert repr(data) == str(data) == f"{data}" == f"<Encoded of {len(data)} bytes, {report!r}>"
    assert repr(encode(picture, packets=120)).startswith("<EncodedPackets of ")
    assert repr(gscl.info(data)).startswith("Info(width=96, height=64, channels=3, dtype='uint8', ")
    assert len(repr(gscl.info(data))) < 250
    assert repr(gscl.compare(picture, picture)).startswith("Comparison(mse=0, psnr=inf, ssim=1, ")


def test_repeats(picture, data):
    assert encode(picture) == data


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_threads(picture, data, threads):
    assert encode(picture, device="host", threads=threads) == data


def test_devices(picture):
    """Files of different devices differ, and are of the same quality in the mean of seeds, which differ by up to 2.7 dB."""
    host, opencl = (
        sum(psnr(picture, gscl.decode(encode(picture, seed=seed, device=device))) for seed in range(1, 17)) / 16
        for device in ("host", "0.0")
    )
    assert opencl == pytest.approx(host, abs=0.7)


@pytest.mark.parametrize(
    "options",
    [
        {"seed": 2},
        {"effort": 1},
        {"tune": "ssim"},
        {"step_factor": 2.0},
        {"effects_off": ["anisotropy", "rotation"]},
        {"progressive": True},
        {"blend": "sum"},
    ],
    ids=str,
)
def test_settings_matter(picture, data, options):
    other = encode(picture, **options)
    assert len(other) <= 400 and other != data
    assert psnr(picture, gscl.decode(other)) > 20


def test_effects(picture):
    info = gscl.info(encode(picture, effects_off={"rotation", "anisotropy"}, effects_on="opacity"))
    assert "opacity" in info.effects and "rotation" not in info.effects


def test_bare(picture, data):
    bare = encode(picture, bare=True, bytes=150)
    with pytest.raises(gscl.Error):
        gscl.decode(bare)
    assert gscl.decode(bare, bare=True).shape == picture.shape
    assert gscl.info(bare, bare=True).width == 96
    assert len(gscl.splats(bare, bare=True)) == gscl.info(bare, bare=True).splats


# ---- Arrays ------------------------------------------------------------------------------------


@pytest.mark.parametrize("channels", [1, 2, 3, 4])
@pytest.mark.parametrize("dtype", ["uint8", "uint16", "float32"])
def test_kinds_of_arrays(channels, dtype):
    picture = make_picture(40, 32, channels, dtype)
    decoded = gscl.decode(encode(picture))
    assert decoded.shape == picture.shape
    assert decoded.dtype == (numpy.uint8 if dtype == "uint8" else numpy.uint16)
    assert psnr(picture, decoded) > 25


def test_other_layouts_of_memory(picture, data):
    wide = numpy.zeros((64, 96, 6), numpy.uint8)
    wide[:, :, ::2] = picture
    upside_down = numpy.ascontiguousarray(picture[::-1])
    readonly = picture.copy()
    readonly.flags.writeable = False
    for same in wide[:, :, ::2], upside_down[::-1], numpy.asfortranarray(picture), readonly, picture.tolist():
        if isinstance(same, list):
            same = numpy.array(same, dtype=numpy.uint8)
        assert encode(same) == data


def test_other_floats_and_byte_orders():
    half = make_picture(40, 32, 3, numpy.float32).astype(numpy.float16)
    assert encode(half) == encode(half.astype(numpy.float64)) == encode(half.astype(numpy.float32))
    words = make_picture(40, 32, 3, numpy.uint16)
    assert encode(words.astype(">u2")) == encode(words.astype("<u2"))


def test_one_channel_axis():
    grey = make_picture(40, 32, 1)
    assert encode(grey[:, :, None]) == encode(grey)


@pytest.mark.parametrize("shape", [(8,), (8, 8, 5), (8, 8, 0), (2, 8, 8, 3)])
def test_wrong_shapes(shape):
    with pytest.raises(gscl.InvalidArgumentError, match="shape"):
        encode(numpy.zeros(shape, numpy.uint8))


@pytest.mark.parametrize("dtype", ["int8", "int32", "uint32", "bool", "complex64", "object"])
def test_wrong_types(dtype):
    with pytest.raises(TypeError, match="expected uint8, uint16 or float"):
        encode(numpy.zeros((8, 8), dtype))


def test_bytes_are_no_picture(data):
    with pytest.raises(TypeError, match="not bytes"):
        encode(data)


# ---- Files and images of Pillow ------------------------------------------------------------------


def test_paths(picture, data, tmp_path):
    path = tmp_path / "picture.png"
    Image.fromarray(picture).save(path)
    assert encode(path) == encode(str(path)) == encode(Image.fromarray(picture)) == data


class Reader:
    """A file that can only be read, such as the answer of a server."""

    def __init__(self, data):
        self.read = (io.StringIO if isinstance(data, str) else io.BytesIO)(data).read


def test_open_files(picture, data, tmp_path):
    path = tmp_path / "picture.png"
    Image.fromarray(picture).save(path)
    with open(path, "rb") as file:
        assert encode(file) == data and not file.closed
    written = io.BytesIO()
    Image.fromarray(picture).save(written, "PNG")  # and stays at its end
    assert encode(written) == encode(Reader(path.read_bytes())) == data
    with subprocess.Popen(["cat", path], stdout=subprocess.PIPE, bufsize=0) as process:
        assert encode(process.stdout) == data
    with open(path, "rb") as file:
        assert gscl.compare(file, path).psnr == math.inf


def test_text_files(data, tmp_path):
    path = tmp_path / "picture.gscl"
    path.write_bytes(data)
    message = "a file that is open as text; open it in binary mode"
    for use in gscl.encode, gscl.decode:
        with open(path, encoding="utf-8") as file, pytest.raises(TypeError, match=f"picture.gscl: {message}"):
            use(file)
        for file in io.StringIO("text"), Reader("text"):
            with pytest.raises(TypeError, match=f"^{message}"):
                use(file)


def test_missing_file(tmp_path):
    with pytest.raises(FileNotFoundError):
        encode(tmp_path / "nothing.png")


def test_no_image_file(tmp_path):
    path = tmp_path / "text.png"
    path.write_text("no picture")
    with pytest.raises(OSError, match="text.png"):
        encode(path)


@pytest.mark.parametrize(
    "mode, shape",
    [
        ("1", ()),
        ("L", ()),
        ("LA", (2,)),
        ("La", (2,)),
        ("P", (3,)),
        ("RGB", (3,)),
        ("RGBA", (4,)),
        ("RGBa", (4,)),
        ("YCbCr", (3,)),
        ("I;16", ()),
        ("I", ()),
        ("F", ()),
    ],
)
def test_modes_of_pillow(mode, shape):
    colours = Image.fromarray(make_picture(40, 32))
    if mode == "I;16":
        image = Image.fromarray(make_picture(40, 32, 1, numpy.uint16))
        assert image.mode == mode
    elif mode == "F":
        image = Image.fromarray(make_picture(40, 32, 1, numpy.float32))
    elif mode == "La":
        image = colours.convert("LA").convert("La")
    elif mode == "RGBa":
        image = colours.convert("RGBA").convert("RGBa")
    else:
        image = colours.convert(mode)
    decoded = gscl.decode(encode(image))
    assert decoded.shape in ((32, 40) + shape, (32, 40) + (() if shape == (2,) else (3,) if shape == (4,) else shape))
    assert decoded.dtype == (numpy.uint16 if mode in ("I;16", "I", "F") else numpy.uint8)


@pytest.mark.parametrize("mode", ["CMYK", "LAB"])
def test_colours_without_meaning(mode):
    image = Image.fromarray(make_picture(40, 32))
    image = image.convert("CMYK") if mode == "CMYK" else ImageCms.applyTransform(image, lab_transform())
    with pytest.raises(gscl.InvalidArgumentError, match="convert it to RGB first"):
        encode(image)


def lab_transform():
    srgb, lab = ImageCms.createProfile("sRGB"), ImageCms.createProfile("LAB")
    return ImageCms.buildTransform(srgb, lab, "RGB", "LAB")


@pytest.mark.parametrize("picture", [255 * make_picture(40, 32, 1, numpy.float32), -1 + make_picture(40, 32, 3, numpy.float64)])
def test_samples_outside_warn(picture):
    count = int(((picture < -0.01) | (picture > 1.01)).sum())
    with pytest.warns(UserWarning, match=f"^{count} samples lie outside 0..1 and are clamped"):
        encode(picture)
    if picture.ndim == 2:
        with pytest.warns(UserWarning, match=f"^{count} samples"):
            encode(Image.fromarray(picture))


def test_samples_of_32_bits():
    image = Image.fromarray(numpy.full((8, 8), 70000, numpy.int32))
    with pytest.raises(gscl.InvalidArgumentError, match="mode I with samples of 70000 to 70000; 0 to 65535"):
        encode(image)


def test_formats_that_are_not_read(tmp_path):
    Image.fromarray(make_picture(40, 32)).save(tmp_path / "a.pcx")
    with pytest.raises(gscl.InvalidArgumentError, match="PCX, which is not read; convert it to PNG first"):
        encode(tmp_path / "a.pcx")
    with Image.open(tmp_path / "a.pcx") as image:
        encode(image.copy())


def test_transparent_palette():
    image = Image.fromarray(make_picture(40, 32)).quantize(16)
    image.info["transparency"] = 0
    assert gscl.decode(encode(image)).shape == (32, 40, 4)


def test_orientation(tmp_path):
    picture = make_picture(48, 32)
    exif = Image.Exif()
    exif[0x0112] = 6  # the first row is at the right
    exif[0x010E] = "a disc"
    path = tmp_path / "turned.jpg"
    Image.fromarray(picture).save(path, exif=exif, quality=95)
    data = encode(path, exif=True, bytes=600)
    decoded = gscl.decode(data)
    assert decoded.shape == (48, 32, 3)
    assert psnr(numpy.rot90(picture, -1), decoded) > 25
    kept = Image.Exif()
    kept.load(gscl.metadata(data)["exif"])
    assert kept.get(0x0112, 1) == 1 and kept[0x010E] == "a disc"


# ---- Colours and metadata ------------------------------------------------------------------------


def test_colours_become_srgb():
    picture = make_picture(40, 32)
    image = Image.fromarray(picture)
    image.info["icc_profile"] = icc_rgb(DISPLAY_P3)
    expected = numpy.array(
        [[[255 * value for value in srgb_of(pixel / 255, DISPLAY_P3)] for pixel in row] for row in picture]
    )
    expected = numpy.rint(expected).astype(numpy.uint8)
    converted = gscl.decode(encode(image, bytes=800))
    assert psnr(expected, converted) > psnr(picture, converted) + 3
    assert "icc_profile" not in gscl.metadata(encode(image))


def test_alpha_survives_conversion():
    picture = make_picture(40, 32, 4)
    image = Image.fromarray(picture)
    image.info["icc_profile"] = icc_rgb(DISPLAY_P3)
    decoded = gscl.decode(encode(image, bytes=800))
    assert abs(decoded[:, :, 3].astype(int) - picture[:, :, 3]).mean() < 10


def test_profile_is_kept(picture):
    image = Image.fromarray(picture)
    image.info["icc_profile"] = icc_rgb(DISPLAY_P3)
    budget = 400 + len(image.info["icc_profile"]) + 16
    for choice in True, image.info["icc_profile"]:
        data = encode(image, icc_profile=choice, bytes=budget)
        assert gscl.metadata(data)["icc_profile"] == image.info["icc_profile"]
        assert psnr(picture, gscl.decode(data)) > 25


def png_with_code_points(path, picture, *points):
    """Saves a PNG with a chunk that Pillow does not know."""
    chunks = PngImagePlugin.PngInfo()
    chunks.add(b"cICP", bytes((*points, 0, 1)))
    Image.fromarray(picture).save(path, pnginfo=chunks)


def test_code_points_of_files(tmp_path, picture):
    png_with_code_points(tmp_path / "a.png", picture, 12, 13)
    expected = numpy.array(
        [[[255 * value for value in srgb_of(pixel / 255, DISPLAY_P3)] for pixel in row] for row in picture]
    )
    expected = numpy.rint(expected).astype(numpy.uint8)
    with Image.open(tmp_path / "a.png") as image:
        image.load()
    for source in (tmp_path / "a.png", image):
        data = encode(source, bytes=800)
        assert gscl.metadata(data) == {}
        assert psnr(expected, gscl.decode(data)) > psnr(picture, gscl.decode(data)) + 3
        kept = encode(source, bytes=800, icc_profile=True)
        assert gscl.metadata(kept) == {"cicp": (12, 13)}
        assert psnr(picture, gscl.decode(kept)) > psnr(expected, gscl.decode(kept)) + 3


def test_hdr_is_refused(tmp_path, picture):
    png_with_code_points(tmp_path / "a.png", picture, 9, 16)
    with pytest.raises(gscl.InvalidArgumentError, match=r"HDR colours \(PQ\).*cicp=\(9, 16\)"):
        encode(tmp_path / "a.png")
    assert gscl.metadata(encode(tmp_path / "a.png", cicp=(9, 16))) == {"cicp": (9, 16)}
    assert gscl.metadata(encode(tmp_path / "a.png", icc_profile=True)) == {"cicp": (9, 16)}


def test_colours_that_a_file_cannot_name_are_converted(picture):
    image = Image.fromarray(picture)
    image.info["gamma"] = 1.0
    linear = encode(image, bytes=800)
    assert encode(image, bytes=800, icc_profile=True) == linear
    grey = image.convert("L")
    grey.info["icc_profile"] = icc_rgb(DISPLAY_P3)
    assert gscl.metadata(encode(grey, icc_profile=True, bytes=1500)) == {}


def test_useless_profile_warns(picture, data):
    image = Image.fromarray(picture)
    image.info["icc_profile"] = b"no profile"
    with pytest.warns(UserWarning, match="colour profile cannot be used"):
        assert encode(image) == data


def test_metadata(picture):
    data = encode(picture, exif=b"Exif\0\0II*\0\x08\0\0\0\0\0\0\0", xmp=b"<x/>", cicp=(12, 13))
    assert gscl.metadata(data) == {"exif": b"II*\0\x08\0\0\0\0\0\0\0", "xmp": b"<x/>", "cicp": (12, 13)}
    assert gscl.metadata(encode(picture)) == {}
