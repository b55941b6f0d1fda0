"""Each file of the sweep is read as it says, within 1 of 255 beyond the losses of its format, or is refused with a message.

READ_IMAGES is the program of read_images.c."""

import os

import pytest
import readers
from all_samples import all_samples
from picture import difference

SAMPLES = list(all_samples())


@pytest.fixture(scope="session")
def results(tmp_path_factory):
    """What gscl reads of all files: samples or None, and the message or None."""
    folder = tmp_path_factory.mktemp("files")
    paths = []
    for number, (sample, _) in enumerate(SAMPLES):
        path = folder / f"{number}{sample.suffix}"
        path.write_bytes(sample.data)
        paths.append(str(path))
    return list(readers.gscl(os.environ["READ_IMAGES"], paths))


@pytest.mark.parametrize(
    "number", range(len(SAMPLES)), ids=[f"{s.format}, {s.variant}, by {s.writer}" for s, _ in SAMPLES]
)
def test_is_right_or_refused(number, results):
    sample, is_refused = SAMPLES[number]
    samples, message = results[number]
    if is_refused:
        assert samples is None
        assert len(message) > 20
        return
    assert message is None
    assert difference(samples, sample.expected) <= sample.tolerance + 1e-6
