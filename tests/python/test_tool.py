"""Chains with the tool: what it writes, the package reads, and the reverse.  GSCL names the tool; without it they are skipped."""

import base64
import csv
import io
import json
import os
import subprocess
import sys

import numpy
import pytest
from PIL import Image
from plyfile import PlyData

import gscl
import gscl.batch
from conftest import make_picture, psnr
from profiles import ADOBE_RGB, ADOBE_RGB_GAMMA, icc_rgb
from test_package import run

GSCL = os.environ.get("GSCL", "")
COLUMNS = ["x", "y", "sigma1", "sigma2", "theta", "opacity"]
COLOURS = ["red", "green", "blue", "alpha"]
pytestmark = pytest.mark.skipif(not os.access(GSCL, os.X_OK), reason="needs the tool in GSCL")


@pytest.fixture
def tool(tmp_path):
    """Runs the tool in the folder of the test and returns its standard output."""

    def run(*arguments, **options):
        return subprocess.run([GSCL, *map(str, arguments)], cwd=tmp_path, check=True, stdout=subprocess.PIPE, **options).stdout

    return run


@pytest.fixture
def encoded(tool, tmp_path):
    """Makes a file by the tool, and the picture that the tool decodes from it."""

    def encode(picture, *options, name="in", form=()):
        Image.fromarray(picture).save(tmp_path / f"{name}.png")
        tool("encode", f"{name}.png", "-o", f"{name}.gscl", "--quiet", "--effort", "0", "--bytes", "600", *options, *form)
        tool("decode", f"{name}.gscl", "-o", f"{name}.decoded.png", "--device", "host", *form)
        with Image.open(tmp_path / f"{name}.decoded.png") as image:
            return (tmp_path / f"{name}.gscl").read_bytes(), numpy.asarray(image)

    return encode


@pytest.mark.parametrize(
    "channels, options",
    [(1, ()), (2, ()), (3, ()), (4, ()), (3, ["--progressive"]), (4, ["--profile", "paper"]), (3, ["--blend", "sum"])],
)
def test_files_of_the_tool(encoded, channels, options):
    picture = make_picture(40, 32, channels)
    data, shown = encoded(picture, *options)
    assert numpy.array_equal(gscl.decode(data, device="host"), shown)
    assert numpy.array_equal(numpy.asarray(Image.open(io.BytesIO(data))), gscl.decode(data))
    assert gscl.info(data).channels == channels


def test_sixteen_bits(encoded):
    data, shown = encoded(make_picture(40, 32, 1, numpy.uint16))
    assert gscl.info(data).dtype == "uint16"
    assert numpy.array_equal(gscl.decode(data, device="host"), shown)


def test_bare_files_and_text(tool, encoded, picture):
    bare, shown = encoded(picture, form=("--bare",))
    assert numpy.array_equal(gscl.decode(bare, bare=True, device="host"), shown)
    data, shown = encoded(picture)
    text = tool("encode", "in.png", "--quiet", "--effort", "0", "--bytes", "600", "--base64").decode()
    assert base64.urlsafe_b64decode(text.strip() + "==") == data
    for made in (base64.b64encode(data), base64.urlsafe_b64encode(data), base64.encodebytes(data)):
        assert json.loads(tool("info", "-", "--base64", "--json", input=made))["bytes"] == len(data)


def test_first_part_of_a_file(tool, encoded, picture, tmp_path):
    data, _ = encoded(picture, "--progressive")
    for size in (len(data) // 3, len(data) // 2):
        (tmp_path / "part.gscl").write_bytes(data[:size])
        tool("decode", "part.gscl", "--partial", "-o", "part.png", "--device", "host")
        with Image.open(tmp_path / "part.png") as image:
            assert numpy.array_equal(gscl.decode(data[:size], partial=True, device="host"), numpy.asarray(image))


def test_files_through_pipes(encoded, picture):
    data, shown = encoded(picture)
    with subprocess.Popen(["cat"], stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
        process.stdin.write(data)
        process.stdin.close()
        assert numpy.array_equal(gscl.decode(process.stdout, device="host"), shown)


def metadata():
    exif = Image.Exif()
    exif[0x010F] = "maker"
    return exif.tobytes(), b"<x:xmpmeta xmlns:x='adobe:ns:meta/'/>"


def test_metadata_of_the_tool(tool, picture, tmp_path):
    exif, xmp = metadata()
    profile = icc_rgb(ADOBE_RGB, ADOBE_RGB_GAMMA)
    Image.fromarray(picture).save(tmp_path / "in.jpg", exif=exif, xmp=xmp, icc_profile=profile)
    tool("encode", "in.jpg", "-o", "in.gscl", "--quiet", "--effort", "0", "--metadata", "all", "--keep-profile")
    assert gscl.metadata((tmp_path / "in.gscl").read_bytes()) == {"exif": exif[6:], "xmp": xmp, "icc_profile": profile}
    with Image.open(tmp_path / "in.gscl") as image:
        assert image.getexif()[0x010F] == "maker"
        assert (image.info["xmp"], image.info["icc_profile"]) == (xmp, profile)


def test_metadata_of_the_package(tool, picture, tmp_path):
    exif, xmp = metadata()
    data = gscl.encode(picture, bytes=900, effort=0, exif=exif, xmp=xmp, cicp=(12, 13))
    (tmp_path / "out.gscl").write_bytes(data)
    blocks = json.loads(tool("info", "out.gscl", "--json"))["blocks"]
    assert {block["name"]: block["bytes"] for block in blocks} == {"colour-space": 2, "exif": len(exif) - 6, "xmp": len(xmp)}
    for suffix in ("png", "jpg", "tif"):
        tool("decode", "out.gscl", "-o", f"out.{suffix}")
        with Image.open(tmp_path / f"out.{suffix}") as image:
            assert image.getexif()[0x010F] == "maker", suffix
            assert b"adobe:ns:meta/" in (image.info.get("xmp") or image.tag_v2[700]), suffix
            assert image.info["icc_profile"], suffix


@pytest.mark.parametrize("channels", [1, 2, 3, 4])
def test_files_of_the_package(tool, channels, tmp_path):
    picture = make_picture(40, 32, channels)
    for form in ({}, {"bare": True}, {"progressive": True}):
        data = gscl.encode(picture, bytes=400, effort=0, **form)
        (tmp_path / "out.gscl").write_bytes(data)
        tool("decode", "out.gscl", "-o", "out.png", "--device", "host", *(["--bare"] if "bare" in form else []))
        with Image.open(tmp_path / "out.png") as image:
            assert numpy.array_equal(numpy.asarray(image), gscl.decode(data, device="host", bare="bare" in form))


def test_the_same_file_and_report(tool, picture, tmp_path):
    Image.fromarray(picture).save(tmp_path / "in.png")
    report = json.loads(tool("encode", "in.png", "-o", "in.gscl", "--quiet", "--json", "--bytes", "500", "--effort", "1"))
    data = gscl.encode(tmp_path / "in.png", bytes=500, effort=1)
    assert (tmp_path / "in.gscl").read_bytes() == data
    assert (report["bytes"], report["splats"], report["psnr"]) == (len(data), data.report.splats, pytest.approx(data.report.psnr))
    info, found = json.loads(tool("info", "in.gscl", "--json")), gscl.info(data)
    assert [info[name] for name in ("width", "height", "splats", "blend", "work")] == [
        found.width, found.height, found.splats, found.blend, found.work]  # fmt: skip
    compared = json.loads(tool("compare", "in.png", "-", "--json", input=tool("decode", "in.gscl", "-o", "-", "--device", "host")))
    assert compared["psnr"] == pytest.approx(psnr(picture, gscl.decode(data, device="host")), abs=1e-3)


@pytest.mark.parametrize("channels, blend", [(1, "normalized"), (3, "sum"), (4, "alpha")])
def test_exported_splats(tool, encoded, channels, blend, tmp_path):
    """The columns of PLY and CSV are the splats of the package, as plyfile, csv and NumPy read them."""
    data, _ = encoded(make_picture(40, 32, channels), "--blend", blend)
    splats = gscl.splats(data)
    for suffix in ("ply", "csv"):
        tool("export", "in.gscl", "-o", f"out.{suffix}")
    vertices = PlyData.read(tmp_path / "out.ply")["vertex"]
    with open(tmp_path / "out.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    table = numpy.genfromtxt(tmp_path / "out.csv", delimiter=",", names=True, dtype=numpy.float32)
    assert len(vertices) == len(rows) == len(splats) > 5
    assert not vertices["z"].any()
    for i, name in enumerate(COLUMNS + COLOURS):
        own = splats[name] if name in COLUMNS else splats["colour"][:, i - len(COLUMNS)]
        assert numpy.array_equal(vertices[name], own), name
        assert numpy.array_equal(numpy.float32([row[name] for row in rows]), own), name
        assert numpy.array_equal(table[name], own), name


def test_outputs_of_a_batch(tool, tmp_path):
    for i in range(3):
        Image.fromarray(make_picture(40 + i, 32)).save(tmp_path / f"{i}.png")
    gscl.batch.run(str(tmp_path / "*.png"), str(tmp_path / "out"), str(tmp_path / "report"), workers=1, bytes=300, effort=0)
    rows = gscl.batch.read_report(str(tmp_path / "report")).to_pylist()
    assert len(rows) == 3
    for row in rows:
        found = json.loads(tool("info", row["output"], "--json"))
        assert [row[name] for name in ("bytes", "width", "height", "splats")] == [
            found[name] for name in ("bytes", "width", "height", "splats")]  # fmt: skip


def test_report_of_a_run(tool, tmp_path):
    for i in range(3):
        Image.fromarray(make_picture(40 + i, 32)).save(tmp_path / f"{i}.png")
    tool("encode", "0.png", "1.png", "2.png", "--out-dir", "out", "--jsonl", "report", "--quiet", "--effort", "0")
    rows = [json.loads(line) for line in (tmp_path / "report").read_text().splitlines()]
    for row in rows:
        found = gscl.info(tmp_path / row["output"])
        assert [row[name] for name in ("bytes", "width", "height", "splats")] == [
            found.bytes, found.width, found.height, found.splats]  # fmt: skip
    assert len(rows) == 3


@pytest.mark.parametrize(
    "options",
    [["--bytes", "500", "--seed", "3"], ["--psnr", "25", "--tune", "ssim"], ["--bpp", "0.5", "--progressive", "--bare"]],
)
def test_commands_of_the_package(tool, picture, options, tmp_path):
    """python -m gscl has options of the tool, and makes the same of them."""
    Image.fromarray(picture).save(tmp_path / "in.png")

    def package(*arguments):
        return run(sys.executable, "-m", "gscl", *arguments, cwd=tmp_path)

    encode = ["encode", "in.png", "--quiet", "--effort", "0", "--device", "host", "--threads", "1", *options, "-o"]
    tool(*encode, "in.gscl")
    package(*encode, "out.gscl")
    assert (tmp_path / "in.gscl").read_bytes() == (tmp_path / "out.gscl").read_bytes()
    form = ["--bare"] if "--bare" in options else []
    for decode in [["--size", "48x32", "--crop", "3,4,20,10"], ["--max-pixels", "10000", "--max-work", "100000000", "--partial"]]:
        arguments = ["decode", "in.gscl", "--device", "host", *decode, *form, "-o"]
        tool(*arguments, "tool.png")
        package(*arguments, "package.png")
        shown = [numpy.asarray(Image.open(tmp_path / name)) for name in ("tool.png", "package.png")]
        assert numpy.array_equal(*shown) and shown[0].any()
    found = [json.loads(program("info", "in.gscl", "--json", *form)) for program in (tool, package)]
    assert all(found[0][name] == found[1][name] for name in ("bytes", "width", "height", "splats", "blend", "profile", "work"))
