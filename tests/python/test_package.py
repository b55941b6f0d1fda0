"""The installed package: types, names, the example, machines without OpenCL."""

import importlib.metadata
import inspect
import os
import pathlib
import re
import subprocess
import sys

import numpy
import pytest

import gscl
from conftest import HERE

PACKAGE = pathlib.Path(gscl.__file__).parent
ROOT = HERE.parents[1]


def run(*arguments, **options):
    done = subprocess.run(arguments, capture_output=True, text=True, **options)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_version():
    version = (ROOT / "host/include/gscl/version.h").read_text().split('#define GSCL_VERSION "')[1].split('"')[0]
    assert gscl.__version__ == importlib.metadata.version("gscl") == version


def test_is_installed():
    """The tests are of the package in a wheel, with its marker of types, not of the sources."""
    assert ROOT / "host" not in PACKAGE.parents
    assert (PACKAGE / "py.typed").exists()


def test_every_public_name():
    assert all(hasattr(gscl, name) for name in gscl.__all__)
    for name in gscl.__all__:
        assert inspect.getdoc(getattr(gscl, name)) or name == "SPLAT_DTYPE", name


@pytest.fixture(scope="module")
def mypy(tmp_path_factory):
    """Checks types in a folder without configuration, and returns the errors."""
    folder = tmp_path_factory.mktemp("mypy")
    command = [sys.executable, "-m", "mypy", "--strict", "--cache-dir", str(folder / "cache")]

    def check(*sources):
        done = subprocess.run([*command, *map(str, sources)], capture_output=True, text=True, cwd=folder)
        assert not done.stderr, done.stderr
        return [line for line in done.stdout.splitlines() if "error:" in line]

    return check


def test_types_of_the_package(mypy):
    assert mypy("-p", "gscl") == []


def test_types_of_a_program(mypy):
    assert mypy(HERE / "typed_use.py") == []


def test_wrong_types_are_found(mypy, tmp_path):
    wrong = tmp_path / "wrong.py"
    wrong.write_text('import gscl\ngscl.encode("x.png", bytes="many")\ngscl.decode(b"", size=3)\n')
    assert len(mypy(wrong)) == 2


def test_library_needs_nothing_else():
    """The package has one module, which links the C library only: it opens the OpenCL loader when it needs a device."""
    (module,) = PACKAGE.glob("*.so")
    lines = run("readelf", "-d", str(module)).splitlines()
    needed = {line.split("[")[1].rstrip("]") for line in lines if "(NEEDED)" in line}
    assert needed <= {"libc.so.6", "libm.so.6"}


WITHOUT_DEVICES = """
import sys
import gscl
assert gscl.decode(sys.argv[1], size=(2400, 1600)).shape == (1600, 2400, 3)
for use in gscl.devices, lambda: gscl.encode(gscl.decode(sys.argv[1])):
    try:
        use()
        sys.exit("there is a device")
    except gscl.NoPlatformError as error:
        pass
"""


@pytest.mark.parametrize("missing", ["devices", "loader"])
def test_without(missing, data, tmp_path):
    path = tmp_path / "picture.gscl"
    path.write_bytes(data)
    (tmp_path / "libOpenCL.so.1").touch()  # no library
    variable = {"devices": "OCL_ICD_VENDORS", "loader": "LD_LIBRARY_PATH"}[missing]
    run(sys.executable, "-c", WITHOUT_DEVICES, str(path), env={**os.environ, variable: str(tmp_path)})


def test_example(picture, tmp_path):
    """It draws the picture, its ellipses and a curve."""
    from PIL import Image

    source, figure = tmp_path / "picture.png", tmp_path / "figure.png"
    Image.fromarray(picture).save(source)
    environment = {**os.environ, "MPLBACKEND": "Agg", "MPLCONFIGDIR": str(tmp_path)}
    program = ROOT / "host/python/examples/ellipses_and_rates.py"
    output = run(sys.executable, str(program), str(source), str(figure), "--effort", "0", env=environment)
    assert "dB" in output
    drawn = numpy.asarray(Image.open(figure).convert("L"))
    assert drawn.shape[1] > 900 and drawn.std() > 20


def test_readme(picture, tmp_path, monkeypatch):
    """The code of README.md runs, block after block."""
    import matplotlib
    from PIL import Image

    matplotlib.use("Agg")
    monkeypatch.chdir(tmp_path)
    Image.fromarray(picture).save("photo.png")
    blocks = re.findall(r"^```python\n(.*?)^```", (ROOT / "host/python/README.md").read_text(), re.M | re.S)
    names = {}
    for block in blocks:
        exec(block, names)
    assert len(blocks) == 3 and names["image"].size == (64, 43) and names["corner"].shape == (64, 64, 3)
    assert numpy.asarray(Image.open("figure.png").convert("L")).std() > 20
