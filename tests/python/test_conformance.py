"""The conformance set of the format, through the package."""

import json

import numpy
import pytest
from images import read_png

import gscl
from conftest import HERE

SET = HERE.parent / "conformance"
ONE_PACKET = "packets-file"  # is no file, but the package, like the tool, takes it for a list of one
ENTRIES = [entry for entry in json.loads((SET / "index.json").read_text()) if entry["file"] != ONE_PACKET]
ERRORS = {
    "corrupt": gscl.CorruptError,
    "damaged": gscl.DamagedError,
    "newer-version": gscl.NewerVersionError,
    "not-a-gscl-file": gscl.NotGsclError,
    "truncated": gscl.TruncatedError,
    "unknown-block": gscl.UnknownBlockError,
}


def chosen(valid):
    entries = [entry for entry in ENTRIES if (entry["result"] == "valid") == valid]
    return pytest.mark.parametrize("entry", entries, ids=[entry["file"] for entry in entries])


def path(entry):
    return SET / "files" / (entry["file"] + (".gsclp" if entry.get("packets") else ".gscl"))


@chosen(valid=True)
@pytest.mark.parametrize("device", ["host", None])
def test_pictures(entry, device):
    """Samples differ by at most 1/255, as the page allows."""
    if device is None and "picture" not in entry:
        device = "host"
    picture = gscl.decode(path(entry), bare=entry["bare"], device=device)
    height, width = picture.shape[:2]
    step = numpy.iinfo(picture.dtype).max // 255
    if "picture" in entry:
        image = read_png((SET / "pictures" / entry["picture"]).read_bytes())
        assert (image.width, image.height) == (width, height)
        assert image.depth == picture.dtype.itemsize * 8
        expected = numpy.array(image.samples).reshape(picture.shape)
        assert numpy.abs(picture.astype(int) - expected).max() <= step
    for x, y, *samples in entry.get("samples", ()):
        assert numpy.abs(picture[y, x].astype(int) - samples).max() <= step
    assert entry.get("picture") or entry["samples"]


@chosen(valid=False)
def test_errors(entry):
    for reader in gscl.decode, gscl.info, gscl.splats:
        with pytest.raises(ERRORS[entry["result"]]) as caught:
            reader(path(entry), bare=entry["bare"])
        assert str(caught.value).startswith(f"{path(entry)}: ")


def test_one_packet():
    entry = {"file": ONE_PACKET, "packets": True}
    assert gscl.decode(path(entry)).shape == (32, 48, 3) and gscl.info(path(entry)).packets == 1
