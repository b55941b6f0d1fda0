"""Fields: splats of files and of other programs, and packing them."""

import dataclasses
import math
import pathlib
import pickle
import re

import numpy
import pytest

import gscl
from conftest import make_picture, psnr


def some_splats(count=60, blend="normalized", seed=3):
    random = numpy.random.default_rng(seed)
    colour = random.uniform(-0.2, 0.25, (count, 3)) if blend == "sum" else random.uniform(0, 1, (count, 3))
    return gscl.make_splats(
        random.uniform(0, (96, 64), (count, 2)), colour, sigma=random.uniform(0.8, 9, (count, 2)), theta=random.uniform(-4, 4, count)
    )


@pytest.mark.parametrize("blend, channels", [("normalized", 3), ("sum", 1), ("alpha", 4)])
def test_fields_of_files_are_packed_to_their_bytes(blend, channels):
    data = gscl.encode(make_picture(60, 40, channels), bytes=300, effort=1, blend=blend)
    field = gscl.read_field(data)
    assert (field.width, field.height, field.channels, field.blend) == (60, 40, channels, blend)
    packed = gscl.pack(field)
    assert packed == data and packed.report.changed == 0 and math.isinf(packed.report.field_psnr)
    assert pickle.loads(pickle.dumps(packed)).report.splats == packed.report.splats == len(field.splats)
    copy = pickle.loads(pickle.dumps(field))
    assert copy == field == gscl.read_field(data) and hash(copy) == hash(field) and gscl.pack(copy) == data
    assert field != dataclasses.replace(field, splats=field.splats[1:])
    bare = gscl.pack(field, bare=True)
    assert len(bare) == len(data) - 7 and numpy.array_equal(gscl.splats(bare, bare=True), field.splats)


def test_targets():
    splats = some_splats()
    small = gscl.pack(splats, size=(96, 64), blend="normalized", bytes=250)
    plain = gscl.pack(splats, size=(96, 64), blend="normalized", bytes=250, passes=False)
    assert max(len(small), len(plain)) <= 250 and small.report.psnr > plain.report.psnr
    assert math.isnan(small.report.colour_error) and plain.report.colour_error > 0
    assert gscl.pack(splats, size=(96, 64), blend="normalized", psnr=30).report.psnr >= 30
    assert len(gscl.pack(splats, size=(96, 64), blend="normalized", bpp=0.4)) <= 0.4 * 96 * 64 / 8
    with pytest.raises(gscl.ConflictError, match="more than one target: bytes, psnr"):
        gscl.pack(splats, size=(96, 64), blend="normalized", bytes=100, psnr=30)
    with pytest.raises(gscl.BudgetTooSmallError):
        gscl.pack(splats, size=(96, 64), blend="normalized", bytes=9)


def test_reference_and_refining(picture):
    splats = some_splats()
    still = gscl.pack(splats, size=(96, 64), blend="sum", background=(0.5,), bytes=300, reference=picture)
    moved = gscl.pack(splats, size=(96, 64), blend="sum", background=(0.5,), bytes=300, reference=picture, refine=3)
    assert moved.report.psnr > still.report.psnr + 1
    assert still.report.psnr == pytest.approx(psnr(picture, gscl.decode(still)), abs=0.1)


def test_shapes_are_the_same_splats():
    random = numpy.random.default_rng(5)
    centre, colour, sigma = random.uniform(0, 60, (40, 2)), random.uniform(0, 1, (40, 4)), random.uniform(0.6, 8, (40, 2))
    theta = random.uniform(0, math.pi, 40)
    c, s = numpy.cos(theta), numpy.sin(theta)
    axes = numpy.stack([numpy.stack([c, -s], -1), numpy.stack([s, c], -1)], -2)
    covariance = axes @ (sigma[:, :, None] ** 2 * numpy.swapaxes(axes, 1, 2))
    factor = numpy.linalg.cholesky(covariance)
    cholesky = numpy.stack([factor[:, 0, 0], factor[:, 1, 0], factor[:, 1, 1]], -1)
    files = [
        gscl.pack(gscl.make_splats(centre, colour, **shape), size=(60, 60), blend="normalized")
        for shape in ({"sigma": sigma, "theta": theta}, {"covariance": covariance}, {"cholesky": cholesky})
    ]
    assert gscl.info(files[0]).channels == 4
    drawn = [gscl.decode(file, dtype=numpy.float32) for file in files]
    assert psnr(drawn[0], drawn[1]) > 45 and psnr(drawn[0], drawn[2]) > 45


def test_arrays_of_other_programs_may_lack_what_is_usual():
    splats = some_splats(20)
    names = gscl.SPLAT_DTYPE.names[:7]
    short = numpy.zeros(20, [(name, gscl.SPLAT_DTYPE[name]) for name in names])
    for name in names:
        short[name] = splats[name]
    assert gscl.pack(short, size=(96, 64), blend="sum") == gscl.pack(splats, size=(96, 64), blend="sum")
    assert gscl.pack(splats[:0], size=(96, 64), blend="sum", background=(1, 0.5, 0))  # the background alone


def test_errors_name_the_splat():
    def refused(error, message, **values):
        splats = some_splats()
        for name, value in values.items():
            splats[name][41] = value
        with pytest.raises(error, match=message):
            gscl.pack(splats, size=(96, 64), blend="normalized")

    refused(gscl.InvalidArgumentError, "splat 41: x is nan; it must be ", x=math.nan)
    refused(gscl.InvalidArgumentError, "splat 41: sigma2 is 0; it must be 1e-06 to ", sigma2=0)
    refused(gscl.InvalidArgumentError, "splat 41: green is inf", colour=(0, math.inf, 0, 1))
    refused(gscl.FieldError, "splat 41: red - blue is 9, the format has -1 to 1", colour=(9, 0, 0, 1))
    with pytest.raises(gscl.InvalidArgumentError, match="size and blend are missing"):
        gscl.pack(some_splats())
    with pytest.raises(gscl.InvalidArgumentError, match="no field sigma2, theta"):
        gscl.pack(some_splats()[["x", "y", "sigma1", "opacity", "colour"]], size=(9, 9), blend="sum")
    with pytest.raises(gscl.InvalidArgumentError, match=r"splat 1: \[1.0, 2.0, 1.0\] \(xx, xy, yy\) is no covariance"):
        gscl.make_splats([[1, 1], [2, 2]], [1, 1], covariance=[[1, 0, 1], [1, 2, 1]])
    with pytest.raises(gscl.InvalidArgumentError, match=r"colour: shape \(3, 3\): expected \(2, channels\)"):
        gscl.make_splats([[1, 1], [2, 2]], numpy.zeros((3, 3)), sigma=[1, 1])
    with pytest.raises(gscl.ConflictError, match="give one of"):
        gscl.make_splats([[1, 1]], [1])
    with pytest.raises(TypeError, match="expected a Field, or a structured array"):
        gscl.pack(numpy.zeros((3, 9)), size=(9, 9), blend="sum")


README = pathlib.Path(__file__).resolve().parents[2] / "host" / "python" / "README.md"


@pytest.mark.parametrize("blend, effects", [("normalized", ["texture", "opacity"]), ("alpha", ["opacity"]), ("sum", ["texture"])])
@pytest.mark.parametrize("channels", [1, 2, 3, 4])
def test_program_of_the_readme_draws_fields(blend, effects, channels):
    program = {}
    (text,) = re.findall(r"```python\n(import gscl\nimport numpy\n.*?def draw\(.*?)```", README.read_text("utf-8"), re.DOTALL)
    assert len(text.splitlines()) <= 40
    exec(compile(text, "README.md", "exec"), program)
    picture = make_picture(60, 40, channels)
    data = gscl.encode(picture, bytes=300, effort=1, blend=blend, effects_on=effects)
    drawn, decoded = program["draw"](gscl.read_field(data)), gscl.decode(data, dtype=float).reshape(40, 60, channels)
    assert abs(drawn - decoded).max() < 1 / 255
