"""The installed package: types, names, the example, what it needs, machines without OpenCL."""

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


def test_metadata():
    """What pip and package indexes show."""
    found = importlib.metadata.metadata("gscl")
    assert found["Summary"] == "Image codec that stores a picture as 2D Gaussians"
    assert (found["Author"], found["License-Expression"]) == ("gscl contributors", "BSD-2-Clause")
    assert found["Requires-Python"] == ">=3.10"
    assert {"image", "codec", "Gaussian splatting"} <= set(found["Keywords"].split(","))
    kinds = found.get_all("Classifier")
    assert {"Typing :: Typed", "Operating System :: POSIX :: Linux", "Programming Language :: Python :: 3.10"} <= set(kinds)
    assert not any(kind.startswith("License ::") for kind in kinds)  # which excludes a license expression
    assert found["Description-Content-Type"] == "text/markdown"
    assert found["Description"].startswith("# gscl for Python\n")
    files = [str(file) for file in importlib.metadata.files("gscl")]
    assert any(name.endswith("/LICENSE") for name in files), files
    assert set(found.get_all("Provides-Extra")) == {"batch", "torch"}


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
    with wrong.open("a") as file:
        file.write('data: bytes = gscl.encode("x.png", packets=152)[0]\ngscl.encode("x.png", packets=152, bare=True)\n')
    assert len(mypy(wrong)) == 4


def test_library_needs_nothing_else():
    """The package has one module, which links the C library only (the parts that it had before glibc 2.34): it opens the OpenCL
    loader when it needs a device."""
    (module,) = PACKAGE.glob("*.so")
    lines = run("readelf", "-d", str(module)).splitlines()
    needed = {line.split("[")[1].rstrip("]") for line in lines if "(NEEDED)" in line}
    loaders = {line for line in needed if line.startswith("ld-linux")}
    assert needed - loaders <= {"libc.so.6", "libm.so.6", "libpthread.so.0", "libdl.so.2"}


def test_module_exports_nothing_else():
    """A libgscl that is loaded in the same process stays apart."""
    (module,) = PACKAGE.glob("*.so")
    names = {line.split()[-1] for line in run("nm", "-D", "--defined-only", str(module)).splitlines()}
    assert names == {"PyInit__gscl"}


THREADS = """
import os, sys, time
import gscl
def threads():
    return len(os.listdir("/proc/self/task")) - others
def become(count):  # a thread that ended is there for a moment
    until = time.monotonic() + 60
    while threads() != count and time.monotonic() < until:
        time.sleep(0.01)
    return threads() == count
others = 0
others = threads() - 1  # of other packages
for count in 1, 3:
    drawn = gscl.decode(sys.argv[1], size=(6000, 4000), device="host", threads=count)
    assert become(count), threads()
gscl.encode(drawn[:50, :50], device="host", effort=0)
assert "libOpenCL" not in open("/proc/self/maps").read()
gscl.release_devices()
assert become(1), threads()
assert any(device.id == "0.0" for device in gscl.devices())
assert "libOpenCL" in open("/proc/self/maps").read()
"""


def test_threads_and_libraries(data, tmp_path):
    """The device "host" has the threads that it is asked for, as long as its contexts are kept, and leaves OpenCL alone."""
    path = tmp_path / "picture.gscl"
    path.write_bytes(data)
    run(sys.executable, "-c", THREADS, str(path))


HOST_ALONE = """
import sys
import gscl
devices = gscl.devices()
(device,) = devices
assert device.id == "host" and device.is_default and device.compute_units > 0
assert "no OpenCL device was found" in devices.missing and "nvidia-opencl-icd" in devices.missing
first, second = str(devices).splitlines()
assert first.startswith("host: ") and first.endswith(device.why_default) and second == devices.missing
assert gscl.decode(sys.argv[1], size=(2400, 1600)).shape == (1600, 2400, 3)
assert gscl.encode(gscl.decode(sys.argv[1]), effort=0, bytes=400).report.psnr > 30
"""

WITHOUT_DEVICES = """
import sys
import gscl
assert sys.argv[2] in gscl.__file__
assert gscl.decode(sys.argv[1], size=(2400, 1600)).shape == (1600, 2400, 3)
try:
    gscl.encode(gscl.decode(sys.argv[1]), device="host")
    sys.exit("host encodes")
except gscl.NoEncoderError as error:
    assert "kernels" in str(error)
for use in gscl.devices, lambda: gscl.encode(gscl.decode(sys.argv[1])):
    try:
        use()
        sys.exit("there is a device")
    except gscl.NoPlatformError as error:
        assert "no OpenCL device was found" in str(error) and "install" in str(error)
        assert use is not gscl.devices or "no kernels for the processor" in str(error)
import gscl.batch
try:
    gscl.batch.run([], "memory://out", "memory://report", tune="x")
    sys.exit("wrong settings")
except gscl.InvalidArgumentError:
    pass
assert gscl.batch.run([], "memory://out", "memory://report", bytes=100).failed == 0
"""


@pytest.mark.parametrize("missing", ["devices", "loader"])
@pytest.mark.parametrize("kernels", [True, False])
def test_without(missing, kernels, data, tmp_path):
    """Without OpenCL there is the device "host"; in a package without kernels, too, which install.sh made, it only decodes."""
    path = tmp_path / "picture.gscl"
    path.write_bytes(data)
    (tmp_path / "libOpenCL.so.1").touch()  # no library
    variable = {"devices": "OCL_ICD_VENDORS", "loader": "LD_LIBRARY_PATH"}[missing]
    environment = {**os.environ, variable: str(tmp_path)}
    if kernels:
        run(sys.executable, "-c", HOST_ALONE, str(path), env=environment)
    else:
        package = str(pathlib.Path(sys.prefix).parent / "without_kernels")
        run(sys.executable, "-c", WITHOUT_DEVICES, str(path), package, env={**environment, "PYTHONPATH": package})


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
    assert len(blocks) == 6 and names["image"].size == (64, 43) and names["shown"].shape == (128, 192, 3) and names["corner"].shape == (64, 64, 3)
    assert numpy.asarray(Image.open("figure.png").convert("L")).std() > 20
