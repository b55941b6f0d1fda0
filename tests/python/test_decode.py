"""gscl.decode and what reads files without drawing: info, splats, metadata, certain_splats."""

import io
import math

import numpy
import pytest

import gscl
from conftest import make_picture, psnr
from gscl._devices import context_on


def test_sources(picture, data, tmp_path):
    path = tmp_path / "picture.gscl"
    path.write_bytes(data)
    expected = gscl.decode(data)
    with open(path, "rb") as file:
        for source in bytearray(data), memoryview(data), path, str(path), io.BytesIO(data), file:
            assert numpy.array_equal(gscl.decode(source), expected)
    with pytest.raises(FileNotFoundError):
        gscl.decode(tmp_path / "nothing.gscl")
    with pytest.raises(TypeError, match="bytes, a path or an open file"):
        gscl.decode(7)


def test_array_owns_its_memory(data):
    first = gscl.decode(data)
    copy = first.copy()
    for _ in range(20):
        gscl.decode(data, size=(97, 65))
    assert numpy.array_equal(first, copy)
    first[:] = 0
    assert first.flags.writeable and first.flags.c_contiguous


def test_size_and_crop(data):
    whole = gscl.decode(data, size=(192, 128))
    assert whole.shape == (128, 192, 3)
    part = gscl.decode(data, size=(192, 128), crop=(30, 20, 50, 40))
    assert part.shape == (40, 50, 3)
    assert abs(part.astype(int) - whole[20:60, 30:80]).max() <= 1


@pytest.mark.parametrize(
    "options",
    [
        {"size": (0, 0)},
        {"size": (0, 5)},
        {"size": (-1, 5)},
        {"size": (5,)},
        {"size": (2**40, 5)},
        {"crop": (0, 0, 0, 5)},
        {"crop": (-1, 0, 5, 5)},
        {"crop": (90, 60, 10, 10)},
        {"max_pixels": 0},
        {"max_work": -1},
        {"dtype": "int32"},
    ],
    ids=str,
)
def test_arguments_out_of_range(data, options):
    with pytest.raises(ValueError) as caught:
        gscl.decode(data, **options)
    assert isinstance(caught.value, gscl.InvalidArgumentError)


@pytest.mark.parametrize("dtype, peak", [("uint8", 255), (numpy.uint16, 65535), (numpy.float32, 1)])
def test_types(data, dtype, peak):
    decoded = gscl.decode(data, dtype=dtype)
    assert decoded.dtype == dtype
    assert numpy.abs(decoded / peak - gscl.decode(data) / 255).max() <= 1.01 / 255


@pytest.mark.parametrize("dtype", [float, "float16", "float64", ">f4"])
def test_floating_point(data, dtype):
    """All come from the samples of float32, which are not rounded to integers."""
    decoded, samples = gscl.decode(data, dtype=dtype), gscl.decode(data, dtype="float32")
    assert decoded.dtype == dtype and numpy.array_equal(decoded, samples.astype(dtype))
    assert numpy.abs(samples - gscl.decode(data, dtype="uint16") / 65535).max() < 0.51 / 65535
    assert 0 <= samples.min() and samples.max() <= 1 and (samples * 65535 % 1 != 0).any()


def test_byte_order(data):
    swapped = gscl.decode(data, dtype=">u2")
    assert swapped.dtype == ">u2" and numpy.array_equal(swapped, gscl.decode(data, dtype="uint16"))


@pytest.mark.parametrize("dtype", ["uint8", "uint16", "float16", "float32", "float64", ">u2"])
def test_out(data, dtype):
    out = numpy.zeros((64, 96, 3), dtype)
    assert gscl.decode(data, out=out) is out and gscl.decode(data, out=out, dtype=dtype) is out
    assert numpy.array_equal(out, gscl.decode(data, dtype=dtype))
    assert out.max() > 0


def test_out_with_strides(data):
    """Parts and views of larger arrays."""
    batch, planes = numpy.zeros((2, 40, 60, 3), numpy.uint8), numpy.zeros((3, 64, 96), numpy.float32)
    gscl.decode(data, size=(96, 64), crop=(10, 5, 30, 20), out=batch[1, ::2, ::-2])
    assert numpy.array_equal(batch[1, ::2, ::-2], gscl.decode(data)[5:25, 10:40])
    assert not batch[0].any() and not batch[1, 1::2].any()
    gscl.decode(data, out=planes.transpose(1, 2, 0))
    assert numpy.array_equal(planes[2], gscl.decode(data, dtype="float32")[:, :, 2])


def test_out_of_grey_and_of_pieces():
    data = gscl.encode(make_picture(40, 32, 1), effort=0, bytes=200)
    out = numpy.zeros((32, 40), numpy.uint8)
    assert gscl.decode(data, out=out) is out and numpy.array_equal(out, gscl.decode(data))
    decoder = gscl.Decoder()
    decoder.add_bytes(data)
    small = numpy.zeros((16, 20), numpy.float32)
    assert decoder.image(size=(20, 16), out=small) is small and small.any()


def read_only(array):
    array.flags.writeable = False
    return array


@pytest.mark.parametrize(
    "kind, message, out, options",
    [
        (gscl.InvalidArgumentError, r"shape \(64, 96\): expected \(64, 96, 3\)", numpy.zeros((64, 96), numpy.uint8), {}),
        (gscl.InvalidArgumentError, r"expected \(64, 96, 3\)", numpy.zeros((1, 64, 96, 3), numpy.uint8), {}),
        (gscl.InvalidArgumentError, r"expected \(32, 48, 3\)", numpy.zeros((64, 96, 3), numpy.uint8), {"size": (48, 32)}),
        (gscl.InvalidArgumentError, r"expected \(8, 9, 3\)", numpy.zeros((64, 96, 3), numpy.uint8), {"crop": (0, 0, 9, 8)}),
        (gscl.InvalidArgumentError, "out: int32: expected uint8, uint16 or a f", numpy.zeros((64, 96, 3), numpy.int32), {}),
        (gscl.InvalidArgumentError, "out: the array is read-only", read_only(numpy.zeros((64, 96, 3), numpy.uint8)), {}),
        (gscl.ConflictError, "uint16, and out is an array of uint8", numpy.zeros((64, 96, 3), numpy.uint8), {"dtype": "uint16"}),
        (TypeError, "out: expected an array of NumPy, not bytearray", bytearray(64 * 96 * 3), {}),
        (gscl.LimitError, "6144", numpy.zeros((64, 96, 3), numpy.uint8), {"max_pixels": 6143}),
    ],
)
def test_out_that_does_not_fit(data, kind, message, out, options):
    with pytest.raises(kind, match=message):
        gscl.decode(data, out=out, **options)
    assert not numpy.any(out)


def test_out_and_damage(data):
    out = numpy.zeros((64, 96, 3), numpy.uint8)
    with pytest.raises(gscl.DamagedError):
        gscl.decode(data[:-1] + bytes([data[-1] ^ 1]), out=out)
    with pytest.raises(gscl.NotGsclError):
        gscl.decode(b"no file", out=out)
    assert not out.any()


def test_premultiplied():
    data = gscl.encode(make_picture(40, 32, 4), effort=0, bytes=400)
    plain, product = gscl.decode(data, dtype="float32"), gscl.decode(data, dtype="float32", premultiplied=True)
    assert numpy.abs(plain[:, :, :3] * plain[:, :, 3:] - product[:, :, :3]).max() < 0.01


def test_limits(data):
    with pytest.raises(gscl.LimitError, match="6144"):
        gscl.decode(data, max_pixels=6143)
    with pytest.raises(gscl.LimitError):
        gscl.decode(data, max_work=10)
    assert gscl.decode(data, max_pixels=6144).shape == (64, 96, 3)


def test_partial(picture, data):
    half = data[: len(data) // 2]
    certain, total = gscl.certain_splats(half)
    assert 0 < certain < total == gscl.info(data).splats
    with pytest.raises(gscl.TruncatedError):
        gscl.decode(half)
    partial = gscl.decode(half, partial=True)
    assert 10 < psnr(picture, partial) < psnr(picture, gscl.decode(data))


def test_devices(data):
    host = gscl.decode(data, device="host")
    for device in gscl.devices():
        assert device.name and device.compute_units > 0
        assert numpy.abs(gscl.decode(data, device=device.id).astype(int) - host).max() <= 1
    assert sum(device.is_default for device in gscl.devices()) == 1
    assert [device.id for device in gscl.devices()].count("host") == 1 and len(gscl.devices()) > 1
    assert gscl.devices().missing == ""
    lines = repr(gscl.devices()).splitlines()
    assert len(lines) == len(gscl.devices()) and lines[-1].startswith("host: ")
    for line, device in zip(lines, gscl.devices()):
        assert ("; the default: " + device.why_default in line) == device.is_default
    gscl.release_devices()
    assert numpy.array_equal(gscl.decode(data, device="host"), host)


def test_default_device(data, monkeypatch):
    """The device "host" up to three megapixels, else the default one."""
    from gscl import _decode

    used = []
    monkeypatch.setattr(_decode, "context_on", lambda device, threads: used.append(device) or context_on(device, threads))
    for options in {}, {"size": (2400, 1600)}, {"size": (2400, 1600), "crop": (100, 100, 500, 500)}:
        gscl.decode(data, **options)
    assert used == ["host", None, "host"]


def test_threads(data):
    """Samples do not depend on them."""
    one = gscl.decode(data, size=(1200, 800), device="host", threads=1)
    for threads in 2, 5, 0:
        assert numpy.array_equal(gscl.decode(data, size=(1200, 800), device="host", threads=threads), one)


def test_info(data):
    info = gscl.info(data)
    assert (info.width, info.height, info.channels, info.dtype) == (96, 64, 3, "uint8")
    assert (info.profile, info.blend, info.layers) == ("default", "normalized", 1)
    assert "chroma" in info.effects and "alpha-channel" not in info.effects
    assert sum(info.streams.values()) == pytest.approx(8 * len(data)) and info.bytes == len(data)
    assert info.pixels == 96 * 64 and 0 < info.work < gscl.info(data, header_only=True).work
    damaged = data[:-1] + bytes([data[-1] ^ 1])
    assert gscl.info(damaged, header_only=True).width == 96
    with pytest.raises(gscl.DamagedError):
        gscl.info(damaged)


def test_splats(data):
    splats = gscl.splats(data)
    assert splats.dtype == gscl.SPLAT_DTYPE and splats.shape == (gscl.info(data).splats,)
    assert (splats["sigma1"] > 0).all() and (splats["theta"] <= math.pi).all()
    assert splats["colour"].shape == (len(splats), 4)


def test_splats_draw_the_picture(data):
    """The normalized blend, drawn from the splats alone."""
    y, x = numpy.mgrid[0:64, 0:96] + 0.5
    sums = numpy.zeros((64, 96, 4))
    weights = numpy.full((64, 96, 1), 1e-9)
    for splat in gscl.splats(data):
        along = math.cos(splat["theta"]) * (x - splat["x"]) + math.sin(splat["theta"]) * (y - splat["y"])
        across = math.cos(splat["theta"]) * (y - splat["y"]) - math.sin(splat["theta"]) * (x - splat["x"])
        weight = numpy.exp(-0.5 * ((along / splat["sigma1"]) ** 2 + (across / splat["sigma2"]) ** 2))[:, :, None]
        sums += weight * splat["colour"]
        weights += weight
    drawn = numpy.clip(sums / weights, 0, 1)[:, :, :3]
    assert psnr(drawn, gscl.decode(data)) > 30


def test_compare(picture):
    same = gscl.compare(picture, picture)
    assert same.psnr == math.inf and same.max_difference == 0 and same.ssimulacra2 == 100
    other = gscl.compare(picture, 255 - picture)
    assert other.psnr < 15 and other.ssim < 0.9
    with pytest.raises(gscl.InvalidArgumentError):
        gscl.compare(picture, picture[:10])
