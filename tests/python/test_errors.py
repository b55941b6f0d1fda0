"""Exceptions: one for each result of the library, with its message."""

import multiprocessing
import os
import re
import signal
import warnings

import numpy
import pytest

import gscl
from conftest import HERE, make_picture
from gscl._errors import _BY_CODE, check

HEADER = (HERE.parents[1] / "host/include/gscl/gscl.h").read_text()
RESULTS = {int(code): name for name, code in re.findall(r"GSCL_ERROR_(\w+) = (\d+)", HEADER)}


def test_every_result_has_an_exception():
    assert len(RESULTS) > 20
    assert {code: kind.__name__.lower() for code, kind in _BY_CODE.items()} == {
        code: name.replace("_", "").lower() + "error" for code, name in RESULTS.items()
    }
    for code, kind in _BY_CODE.items():
        assert getattr(gscl, kind.__name__) is kind and issubclass(kind, gscl.Error)
        with pytest.raises(kind, match="^picture: .") as caught:
            check(code, subject="picture")
        assert caught.value.code == code


def test_ordinary_bases():
    for kind, base in {
        gscl.InvalidArgumentError: ValueError,
        gscl.OutOfMemoryError: MemoryError,
        gscl.DeviceMemoryError: MemoryError,
        gscl.UnknownDeviceError: LookupError,
        gscl.DamagedError: ValueError,
        gscl.BudgetTooSmallError: ValueError,
    }.items():
        assert issubclass(kind, base)


def test_unknown_result():
    with pytest.raises(gscl.Error):
        check(999)


def encode(picture, **options):
    return gscl.encode(picture, **{"effort": 0, **options})


@pytest.mark.parametrize(
    "kind, message, options",
    [
        (gscl.BudgetTooSmallError, r"\d+ bytes", {"bytes": 3}),
        (gscl.TargetUnreachableError, "dB", {"psnr": 200}),
        (gscl.TargetUnreachableError, "SSIMULACRA 2 of 99.90 cannot", {"ssimulacra2": 99.9}),
        (gscl.InvalidArgumentError, "-100..100", {"ssimulacra2": -101}),
        (gscl.InvalidArgumentError, "-100..100", {"ssimulacra2": float("nan")}),
        (gscl.ConflictError, "psnr, ssimulacra2", {"psnr": 30, "ssimulacra2": 30}),
        (gscl.ConflictError, "more than one target: bytes, bpp", {"bytes": 100, "bpp": 1}),
        (gscl.ConflictError, ".", {"profile": "paper", "tune": "ssim"}),
        (gscl.InvalidArgumentError, "effort", {"effort": 10}),
        (gscl.InvalidArgumentError, "effort", {"effort": 2**40}),
        (gscl.InvalidArgumentError, "seed", {"seed": -1}),
        (gscl.InvalidArgumentError, "tune.*expected one of auto, psnr, ssim, visual", {"tune": "beauty"}),
        (gscl.InvalidArgumentError, "effects_on.*chroma", {"effects_on": ["sparkle"]}),
        (gscl.InvalidArgumentError, ".", {"bytes": -5}),
        (gscl.InvalidArgumentError, "cicp", {"cicp": (300, 1)}),
        (gscl.UnknownDeviceError, "no-such-device", {"device": "no-such-device"}),
        (gscl.InvalidArgumentError, "-1 threads", {"threads": -1}),
        (gscl.InvalidArgumentError, "1 to 1024", {"threads": 1025}),
        (gscl.InvalidArgumentError, "threads", {"threads": 2**40}),
    ],
    ids=str,
)
def test_encode(picture, kind, message, options):
    with pytest.raises(kind, match=message):
        encode(picture, **options)


def test_pictures_that_cannot_be_encoded():
    with pytest.raises(gscl.ImageSizeError):
        encode(numpy.zeros((0, 5), numpy.uint8))
    with pytest.raises(gscl.ImageSizeError):
        encode(numpy.zeros((1, 16385), numpy.uint8))
    picture = make_picture(16, 16, dtype=numpy.float32)
    picture[3, 4] = numpy.nan
    with pytest.raises(gscl.ImageNotFiniteError):
        encode(picture)


@pytest.mark.parametrize("options", [{"bytes": "many"}, {"effort": 1.5}, {"nonsense": 1}], ids=str)
def test_wrong_types(picture, options):
    with pytest.raises(TypeError):
        encode(picture, **options)


def test_errors_leave_the_device_usable(picture, data):
    with pytest.raises(gscl.BudgetTooSmallError):
        encode(picture, bytes=3)
    assert encode(picture, bytes=400) == data


LARGE = (3000, 2000)  # pixels: a decode to this size starts threads on the device "host"


@pytest.fixture
def forking():
    """Since Python 3.12 a fork of a process with threads warns."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        yield


def test_fork(picture, data, forking):
    """The child opens contexts of its own on the device "host", which is the default there, too.  OpenCL does not survive a
    fork: the child refuses it instead of waiting for ever."""
    large = gscl.decode(data, size=LARGE, threads=3)
    gscl.decode(data, device="0.0")
    child = os.fork()
    if child == 0:
        signal.alarm(1800)  # ends a child that waits for ever
        try:
            assert encode(picture, bytes=400) == data
            assert numpy.array_equal(gscl.decode(data, size=LARGE, threads=3), large)
            try:
                encode(make_picture(16, 16), device="0.0")
            except gscl.DeviceFailedError as error:
                os._exit(0 if "spawn" in str(error) else 1)
        finally:
            os._exit(2)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    assert encode(picture, bytes=400) == data


def encode_and_draw(picture):
    data = encode(picture, bytes=400)
    return data, gscl.decode(data, size=LARGE)


def test_forked_processes_of_a_pool(picture, data, forking):
    """Processes of multiprocessing that are forked from one whose device "host" has been at work."""
    expected = encode_and_draw(picture)
    assert expected[0] == data
    with multiprocessing.get_context("fork").Pool(2) as pool:
        for found in pool.map_async(encode_and_draw, [picture] * 4).get(1800):
            assert found[0] == data and numpy.array_equal(found[1], expected[1])
