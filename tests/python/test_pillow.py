"""The plugin of Pillow."""

import io
import subprocess
import sys

import numpy
import pytest
from PIL import Image, ImageFile, UnidentifiedImageError

import gscl
from conftest import HERE, make_picture, psnr


def opened(data):
    return Image.open(io.BytesIO(data))


def test_open(picture, data, tmp_path):
    path = tmp_path / "picture.gscl"
    path.write_bytes(data)
    with Image.open(path) as image:
        assert (image.format, image.mode, image.size) == ("GSCL", "RGB", (96, 64))
        assert image.get_format_mimetype() == "image/x-gscl"
        assert numpy.array_equal(numpy.asarray(image), gscl.decode(data))
        assert numpy.array_equal(numpy.asarray(image.copy()), gscl.decode(data))
    assert psnr(picture, Image.open(path).convert("RGB")) > 30


def test_save(picture, data, tmp_path):
    path = tmp_path / "picture.gscl"
    Image.fromarray(picture).save(path, bytes=400, effort=0)
    assert path.read_bytes() == data
    memory = io.BytesIO()
    Image.fromarray(picture).save(memory, "GSCL", bytes=400, effort=0)
    assert memory.getvalue() == data
    Image.fromarray(picture).save(path, quality=30, effort=0)
    assert path.read_bytes() == gscl.encode(picture, quality=30, effort=0)


def test_unknown_options_warn(picture, data, tmp_path):
    path = tmp_path / "picture.gscl"
    with pytest.warns(UserWarning) as warned:
        Image.fromarray(picture).save(path, bytes=400, effort=0, optimize=True, effrot=9)
    assert [str(warning.message).split(",")[0] for warning in warned] == [
        "'optimize' is not an option of gscl files", "'effrot' is not an option of gscl files"]  # fmt: skip
    assert all(f" {name}" in str(warned[0].message) for name in ("bytes", "effort", "icc_profile", "tune"))
    assert {warning.filename for warning in warned} == {__file__}
    assert path.read_bytes() == data


@pytest.mark.parametrize("channels, mode", [(1, "L"), (2, "LA"), (3, "RGB"), (4, "RGBA")])
def test_modes(channels, mode):
    picture = make_picture(40, 32, channels)
    image = opened(gscl.encode(picture, effort=0, bytes=400))
    assert image.mode == mode and psnr(picture, numpy.asarray(image)) > 25


def test_sixteen_bits():
    picture = make_picture(40, 32, 1, numpy.uint16)
    image = opened(gscl.encode(picture, effort=0, bytes=400))
    assert image.mode == "I;16" and psnr(picture, numpy.asarray(image)) > 25
    assert opened(gscl.encode(make_picture(40, 32, 3, numpy.uint16), effort=0, bytes=400)).mode == "RGB"


def test_metadata(picture):
    exif = Image.Exif()
    exif[0x010E] = "a disc"
    memory = io.BytesIO()
    Image.fromarray(picture).save(memory, "GSCL", bytes=900, effort=0, exif=exif, xmp=b"<x/>", icc_profile=b"no profile")
    image = opened(memory.getvalue())
    assert image.getexif()[0x010E] == "a disc"
    assert image.info["xmp"] == b"<x/>" and image.info["icc_profile"] == b"no profile"


def test_draft(picture, data):
    image = opened(data)
    image.draft(None, (30, 10))
    assert image.size == (30, 20)
    assert numpy.array_equal(numpy.asarray(image), gscl.decode(data, size=(30, 20)))
    image.draft(None, (5, 5))
    assert image.size == (30, 20), "is loaded"
    image = opened(data)
    image.draft("RGB", (1000, 1000))
    assert image.size == (96, 64)
    small = numpy.asarray(Image.fromarray(picture).resize((30, 20), Image.Resampling.BOX))
    assert psnr(small, gscl.decode(data, size=(30, 20))) > 28


def test_thumbnail(picture, data):
    image, other = opened(data), Image.fromarray(picture)
    image.thumbnail((24, 24))
    other.thumbnail((24, 24))
    assert image.size == other.size == (24, 16)
    assert psnr(other, image) > 28


@pytest.mark.parametrize("content", [b"", b"gscl", b"\x89PNG", b"\xc7gs"])
def test_other_files(content, tmp_path):
    path = tmp_path / "picture.gscl"
    path.write_bytes(content)
    with pytest.raises(UnidentifiedImageError, match="cannot identify image file"):
        Image.open(path)


def test_bad_header(data):
    newer = data[:4] + bytes([data[4] & 0xF0 | 15]) + data[5:]
    with pytest.raises(UnidentifiedImageError, match="version"):
        opened(newer)
    with pytest.raises(UnidentifiedImageError, match="incomplete"):
        opened(data[:6])


def test_damaged_picture(data):
    damaged = data[:-1] + bytes([data[-1] ^ 255])
    image = opened(damaged)
    with pytest.raises(OSError, match="damaged"):
        image.load()
    with pytest.raises(OSError, match="damaged"):
        opened(damaged).verify()
    opened(data).verify()


def test_truncated_picture(picture, data, monkeypatch):
    half = data[: len(data) // 2]
    with pytest.raises(OSError, match="incomplete|cut off"):
        opened(half).load()
    monkeypatch.setattr(ImageFile, "LOAD_TRUNCATED_IMAGES", True)
    assert psnr(picture, numpy.asarray(opened(half))) > 10


def test_bomb(data, monkeypatch):
    monkeypatch.setattr(Image, "MAX_IMAGE_PIXELS", 96 * 64 - 1)
    with pytest.warns(Image.DecompressionBombWarning):
        opened(data)
    monkeypatch.setattr(Image, "MAX_IMAGE_PIXELS", 96 * 64 // 2 - 1)
    with pytest.raises(Image.DecompressionBombError):
        opened(data)


def test_too_much_work(data, monkeypatch):
    monkeypatch.setattr(gscl.GsclImagePlugin, "MAX_WORK", 10)
    with pytest.raises(Image.DecompressionBombError, match="MAX_WORK"):
        opened(data).load()
    monkeypatch.setattr(gscl.GsclImagePlugin, "MAX_WORK", None)
    opened(data).load()


def test_save_errors(picture, tmp_path):
    path = tmp_path / "picture.gscl"
    with pytest.raises(gscl.BudgetTooSmallError):
        Image.fromarray(picture).save(path, bytes=2, effort=0)
    assert not path.exists()


def test_conformance_set_opens():
    files = sorted((HERE.parent / "conformance/files").glob("block-*.gscl"))
    assert files
    for path in files:
        try:
            expected = gscl.decode(path, dtype="uint8")
        except gscl.FileError:
            with pytest.raises(OSError):
                Image.open(path).load()
        else:
            assert numpy.array_equal(numpy.asarray(Image.open(path)), expected)


def test_registered_by_import():
    program = "from PIL import Image; import gscl; print(Image.registered_extensions()['.gscl'])"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout == "GSCL\n"


def test_reopened_after_pickle(data):
    import pickle

    image = opened(data)
    assert numpy.array_equal(numpy.asarray(pickle.loads(pickle.dumps(image))), gscl.decode(data))
