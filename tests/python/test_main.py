"""python -m gscl."""

import dataclasses
import importlib.metadata
import io
import json
import subprocess
import sys

import numpy
import pytest
from PIL import Image

import gscl
import gscl.__main__
from conftest import make_picture


@pytest.fixture
def folder(picture, data, tmp_path, monkeypatch):
    """With in.png and in.gscl, the file of the fixture `data`."""
    Image.fromarray(picture).save(tmp_path / "in.png")
    (tmp_path / "in.gscl").write_bytes(data)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def run(folder, capfd):
    """Runs a command in this process, and returns its status, its output and its errors."""

    def run(*arguments):
        try:
            status = gscl.__main__.main([str(argument) for argument in arguments])
        except SystemExit as end:
            status = end.code
        return status, *capfd.readouterr()

    return run


def test_help_and_version(run):
    assert run("--version") == (0, f"gscl {importlib.metadata.version('gscl')}\n", "")
    status, text, _ = run("--help")
    assert status == 0 and all(f"    {command} " in text for command in ("encode", "decode", "info", "devices"))
    for command in "encode", "decode", "info":
        assert run(command, "--help")[0] == 0


def test_encode(run, folder, data):
    status, output, line = run("encode", "in.png", "-o", "out.gscl", "--bytes", 400, "--effort", 0)
    report = data.report
    assert (folder / "out.gscl").read_bytes() == data and (status, output) == (0, "")
    assert line.startswith(f"out.gscl: {report.bytes} bytes, {report.splats} splats, {report.psnr:.2f} dB, ")
    assert run("encode", "in.png", "-o", "out.gscl", "--quiet", "--bpp", 0.3, "--effort", 0, "--bare", "--tune", "ssim", "--threads", 2) == (0, "", "")
    assert (folder / "out.gscl").read_bytes() == gscl.encode("in.png", bpp=0.3, effort=0, bare=True, tune="ssim")
    assert "SSIMULACRA 2 2" in run("encode", "in.png", "-o", "out.gscl", "--ssimulacra2", 20, "--effort", 0)[2]


def test_decode(run, folder, data):
    assert run("decode", "in.gscl", "-o", "out.png") == (0, "", "")
    assert numpy.array_equal(Image.open("out.png"), gscl.decode(data))
    assert run("decode", "in.gscl", "-o", "out.png", "--size", "48x32", "--crop", "4,2,20,10", "--device", "host") == (0, "", "")
    assert numpy.array_equal(Image.open("out.png"), gscl.decode(data, size=(48, 32), crop=(4, 2, 20, 10)))
    (folder / "part.gscl").write_bytes(data[:200])
    assert run("decode", "part.gscl", "-o", "out.bmp", "--partial")[0] == 0
    assert numpy.array_equal(Image.open("out.bmp"), gscl.decode(data[:200], partial=True))


@pytest.mark.parametrize("channels, dtype", [(1, "uint8"), (1, "uint16"), (2, "uint8"), (3, "uint16"), (4, "uint8")])
def test_kinds_of_pictures(run, folder, channels, dtype):
    data = gscl.encode(make_picture(40, 32, channels, dtype), effort=0, bytes=300, bare=True)
    (folder / "a.gscl").write_bytes(data)
    assert run("decode", "a.gscl", "-o", "out.png", "--bare") == (0, "", "")
    kind = dtype if channels == 1 else "uint8"
    assert numpy.array_equal(numpy.asarray(Image.open("out.png")), gscl.decode(data, bare=True, dtype=kind))


@pytest.mark.parametrize("suffix", ["png", "jpg", "webp", "tif"])
def test_metadata(run, folder, picture, suffix):
    exif = Image.Exif()
    exif[0x010E] = "a disc"
    (folder / "a.gscl").write_bytes(gscl.encode(picture, effort=0, exif=exif.tobytes(), icc_profile=b"no profile", bytes=600))
    assert run("decode", "a.gscl", "-o", f"out.{suffix}")[0] == 0
    with Image.open(f"out.{suffix}") as image:
        assert image.getexif()[0x010E] == "a disc" and image.info["icc_profile"] == b"no profile"


def test_code_points(run, folder, picture):
    """Colours that Pillow cannot name are converted, or refused."""
    (folder / "a.gscl").write_bytes(gscl.encode(picture, effort=0, cicp=(12, 13)))
    assert run("decode", "a.gscl", "-o", "out.png")[0] == 0
    plain, shown = gscl.decode("a.gscl").astype(int), numpy.asarray(Image.open("out.png")).astype(int)
    inside = plain[32, 48], shown[32, 48]
    assert inside[0][0] > 150 and inside[1][0] > inside[0][0] + 10  # a red of Display P3 needs more of that of sRGB
    (folder / "a.gscl").write_bytes(gscl.encode(picture, effort=0, cicp=(9, 16)))
    status, _, line = run("decode", "a.gscl", "-o", "hdr.png")
    assert status == 1 and "HDR colours (PQ)" in line and not (folder / "hdr.png").exists()


def test_info(run, data):
    status, text, _ = run("info", "in.gscl")
    assert status == 0 and text.startswith("in.gscl: 96 x 64 RGB, uint8, ") and f"\n{data.report.splats} splats, {len(data)} bytes, " in text
    fields = json.loads(run("info", "in.gscl", "--json")[1])
    assert fields == {**dataclasses.asdict(gscl.info(data)), "effects": list(gscl.info(data).effects)}


def test_devices(run):
    assert run("devices") == (0, f"{gscl.devices()}\n", "")


def test_pipes(folder, picture, data):
    def piped(*arguments, given):
        return subprocess.run([sys.executable, "-m", "gscl", *arguments], input=given, stdout=subprocess.PIPE, check=True).stdout

    encoded = piped("encode", "-", "-o", "-", "--quiet", "--bytes", "400", "--effort", "0", given=(folder / "in.png").read_bytes())
    assert encoded == data
    assert numpy.array_equal(Image.open(io.BytesIO(piped("decode", "-", "-o", "-", given=encoded))), gscl.decode(data))
    assert piped("info", "-", given=encoded).startswith(b"-: 96 x 64 RGB")


@pytest.mark.parametrize(
    "status, message, arguments",
    [
        (1, "gscl: nothing.gscl: No such file or directory\n", ["decode", "nothing.gscl", "-o", "out.png"]),
        (1, "gscl: nothing.png: No such file or directory\n", ["encode", "nothing.png", "-o", "out.gscl"]),
        (1, "gscl: no/out.gscl: the folder of this output does not exist\n", ["encode", "nothing.png", "-o", "no/out.gscl"]),
        (1, "gscl: no/out.png: the folder of this output does not exist\n", ["decode", "nothing.gscl", "-o", "no/out.png"]),
        (1, "gscl: in.png: not a gscl file\n", ["decode", "in.png", "-o", "out.png"]),
        (1, "gscl: in.png: not a gscl file\n", ["info", "in.png"]),
        (1, "gscl: out.xyz: Pillow writes no pictures with the suffix '.xyz'; .png would do\n", ["decode", "in.gscl", "-o", "out.xyz"]),
        (1, "6144", ["decode", "in.gscl", "-o", "out.png", "--max-pixels", 6143]),
        (1, "cannot identify image file", ["encode", "text", "-o", "out.gscl"]),
        (1, "no device matches", ["encode", "in.png", "-o", "out.gscl", "--device", "nothing"]),
        (2, "'48': expected WxH", ["decode", "in.gscl", "-o", "out.png", "--size", "48"]),
        (2, "'1,2,3,-4': expected X,Y,W,H", ["decode", "in.gscl", "-o", "out.png", "--crop", "1,2,3,-4"]),
        (2, "required: -o", ["encode", "in.png"]),
        (2, "not allowed with argument --bytes", ["encode", "in.png", "-o", "out.gscl", "--bytes", 1, "--psnr", 30]),
        (2, "invalid choice: 'draw'", ["draw", "in.gscl"]),
        (2, "required: COMMAND", []),
    ],
)
def test_errors(run, folder, status, message, arguments):
    """One line, the status, and no output."""
    (folder / "text").write_text("no picture")
    before = sorted(folder.iterdir())
    found, output, text = run(*arguments)
    assert (found, output) == (status, "") and message in text and sorted(folder.iterdir()) == before
    assert status == 2 or len(text.splitlines()) == 1


def test_warnings_are_lines(run, folder, picture):
    image = Image.fromarray(picture)
    image.save("a.png", icc_profile=b"no profile")
    text = subprocess.run([sys.executable, "-m", "gscl", "encode", "a.png", "-o", "-", "--quiet", "--effort", "0"], capture_output=True).stderr
    assert text.startswith(b"gscl: the colour profile cannot be used") and text.count(b"\n") == 1


def test_output_is_written_whole(run, folder, data):
    """A link stays, an output that is there is replaced, and one that is a device is written in place."""
    (folder / "real.png").write_bytes(b"old")
    (folder / "link.png").symlink_to("real.png")
    assert run("decode", "in.gscl", "-o", "link.png")[0] == 0
    assert (folder / "link.png").is_symlink() and numpy.array_equal(Image.open("real.png"), gscl.decode(data))
    command = [sys.executable, "-m", "gscl", "encode", "in.png", "-o", "/dev/stdout", "--quiet", "--bytes", "400", "--effort", "0"]
    done = subprocess.run(command, stdout=subprocess.PIPE)
    assert done.stdout == data
