"""The Python package sees the same picture in a file as the tool: what the file shows, or an error."""

import warnings

import numpy
import pytest
from all_samples import all_samples
from picture import difference

import gscl
from gscl._images import load

SAMPLES = list(all_samples())


def shown(source):
    samples = source.samples
    samples = samples.clip(0, 1) if samples.dtype.kind == "f" else samples / numpy.iinfo(samples.dtype).max
    return samples[..., None] if samples.ndim == 2 else samples


@pytest.mark.parametrize(
    "number", range(len(SAMPLES)), ids=[f"{s.format}, {s.variant}, by {s.writer}" for s, _ in SAMPLES]
)
def test_is_right_or_refused(number, tmp_path):
    sample, _ = SAMPLES[number]
    path = tmp_path / f"picture{sample.suffix}"
    path.write_bytes(sample.data)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            source = load(path)
    except (gscl.Error, OSError, TypeError, ValueError, SyntaxError, NotImplementedError):
        return
    assert sample.expected is not None
    # Pillow rounds to 8 bits where the tool keeps 16.
    assert difference(shown(source), sample.expected) <= sample.tolerance + 1.1 / 255
