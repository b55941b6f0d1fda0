"""Packets: encoding, decoding those that have come, gscl.Decoder, and the example that sends them."""

import re
import sys
import threading

import numpy
import pytest
from PIL import Image

import gscl
import gscl.batch
from conftest import HERE, psnr
from test_package import run

LIMIT = 60  # seconds: it ends what hangs
EXAMPLE = HERE.parents[1] / "host/python/examples/lossy_link.py"


def encode(picture, **options):
    return gscl.encode(picture, **{"effort": 0, "packets": 120, "packet_count": 6, **options}).packets


@pytest.fixture(scope="module")
def packets(picture):
    """Six packets without repair packets."""
    return encode(picture, packet_identity=7)


@pytest.fixture(scope="module")
def others(picture):
    """Packets of another picture."""
    return encode(255 - picture, packet_identity=8)


@pytest.fixture(scope="module")
def repaired(picture):
    """Packets and, behind them, repair packets: how many have splats, and all of them."""
    found = encode(picture, packet_count=10, packet_loss=0.1)
    return gscl.info(found).packets, found


def damaged(packet):
    return packet[:-1] + bytes([packet[-1] ^ 1])


def test_encode(picture):
    encoded = gscl.encode(picture, packets=120, packet_count=6, packet_identity=7, effort=0)
    packets, report = encoded.packets, encoded.report
    assert len(packets) == 6 and all(type(packet) is bytes and 40 < len(packet) <= 120 for packet in packets)
    assert sum(map(len, packets)) == report.bytes < len(encoded) and numpy.array_equal(gscl.decode(encoded), gscl.decode(packets))
    assert {packet[0] for packet in packets} == {7}
    assert psnr(picture, gscl.decode(packets)) == pytest.approx(report.psnr, abs=0.01) and report.psnr > 30
    assert len(gscl.encode(picture, packets=120, bytes=500, effort=0).packets) == 5
    assert len(gscl.encode(picture, packets=1400, effort=0).packets) == 1


@pytest.mark.parametrize(
    "kind, options",
    [
        (gscl.InvalidArgumentError, {"packets": 0}),
        (gscl.InvalidArgumentError, {"packets": 39}),
        (gscl.InvalidArgumentError, {"packets": 1401}),
        (gscl.InvalidArgumentError, {"packets": 2**40}),
        (gscl.InvalidArgumentError, {"packet_count": 257}),
        (gscl.InvalidArgumentError, {"packet_count": -1}),
        (gscl.InvalidArgumentError, {"packet_identity": 199}),
        (gscl.InvalidArgumentError, {"packet_loss": 0.95}),
        (gscl.ConflictError, {"packets": None}),
        (gscl.ConflictError, {"packets": None, "packet_count": 0, "packet_loss": 0.1}),
        (gscl.ConflictError, {"psnr": 30}),
        (gscl.ConflictError, {"progressive": True}),
    ],
    ids=str,
)
def test_arguments_out_of_range(picture, kind, options):
    with pytest.raises(kind):
        encode(picture, **options)


def test_sources(packets, picture, tmp_path):
    """All ways to name packets, of a list and of one."""
    data = gscl.encode(picture, packets=120, packet_count=6, packet_identity=7, effort=0)
    path, single = tmp_path / "picture.gsclp", tmp_path / "picture.000.gsclp"
    path.write_bytes(data)
    single.write_bytes(packets[0])
    expected = gscl.decode(packets)
    for source in tuple(packets), packets[::-1], [memoryview(packet) for packet in packets], data, bytearray(data), path, str(path):
        assert numpy.array_equal(gscl.decode(source), expected)
    with open(path, "rb") as file:
        assert numpy.array_equal(gscl.decode(file), expected)
    first = gscl.decode(packets[:1])
    for source in packets[0], bytearray(packets[0]), single:
        assert numpy.array_equal(gscl.decode(source), first)
    assert 10 < psnr(picture, first) < psnr(picture, gscl.decode(packets[1:3])) < psnr(picture, expected)
    for source in [7], ["text"]:
        with pytest.raises(TypeError):
            gscl.decode(source)


def test_options(packets):
    whole = gscl.decode(packets, size=(192, 128))
    part = gscl.decode(packets, size=(192, 128), crop=(30, 20, 50, 40))
    assert whole.shape == (128, 192, 3) and abs(part.astype(int) - whole[20:60, 30:80]).max() <= 1
    with pytest.raises(gscl.LimitError):
        gscl.decode(packets, max_pixels=6143)


def test_others_are_left_out(packets, others):
    mixed = [damaged(packets[2]), packets[1], others[3], packets[0], b"", bytes(2**21), *packets, others[0]]
    assert numpy.array_equal(gscl.decode(mixed), gscl.decode(packets))


@pytest.mark.parametrize(
    "kind, source",
    [
        (gscl.TruncatedError, lambda packets: []),
        (gscl.DamagedError, lambda packets: [b""]),
        (gscl.DamagedError, lambda packets: [damaged(packets[0]), b"no packet"]),
        (gscl.NotGsclError, lambda packets: damaged(packets[0])),
    ],
    ids=["none", "empty", "damaged", "one"],
)
def test_no_good_packet(packets, kind, source):
    for reader in gscl.decode, gscl.info, gscl.splats:
        with pytest.raises(kind):
            reader(source(packets))


def test_inspecting(packets, data):
    info = gscl.info(packets)
    assert (info.packets, info.width, info.height) == (6, 96, 64)
    assert info.splats == len(gscl.splats(packets)) == gscl.certain_splats(packets)[0]
    assert (gscl.info(packets[1:4]).packets, gscl.info(packets[0]).packets, gscl.info(data).packets) == (3, 1, 0)
    assert gscl.info(packets, header_only=True).width == 96
    assert gscl.metadata(packets) == {}


def test_repair_packets(repaired):
    count, packets = repaired
    lost = len(packets) - count
    assert 0 < lost < count
    expected = gscl.decode(packets)
    assert numpy.array_equal(gscl.decode(packets[lost:]), expected)
    assert gscl.info(packets[lost + 1 :]).packets == count - lost - 1
    with pytest.raises(gscl.DamagedError):
        gscl.decode(packets[count])  # it draws nothing


def test_decoder(packets, picture):
    decoder = gscl.Decoder()
    assert (decoder.size, decoder.splats, decoder.packets, decoder.drawn, decoder.received) == (None, 0, 0, 0, 0)
    with pytest.raises(gscl.TruncatedError):
        decoder.image()
    for count, packet in enumerate(packets[::-1], 1):
        assert decoder.add(packet) and not decoder.add(bytearray(packet))
        assert (decoder.size, decoder.packets, decoder.drawn, decoder.received) == ((96, 64), 6, count, count)
        assert numpy.array_equal(decoder.image(), gscl.decode(packets[-count:]))
        assert decoder.splats == gscl.info(packets[-count:]).splats
    assert psnr(picture, decoder.image()) > 30
    small = decoder.image(size=(48, 32), crop=(8, 8, 20, 10), dtype="float32")
    assert numpy.array_equal(small, gscl.decode(packets, size=(48, 32), crop=(8, 8, 20, 10), dtype="float32"))
    with pytest.raises(gscl.CancelledError):
        decoder.image(progress=lambda state: False)


def test_decoder_refuses_others(packets, others, data):
    decoder = gscl.Decoder()
    decoder.add(packets[0])
    expected = decoder.image()
    for kind, packet in {
        gscl.OtherPictureError: others[0],
        gscl.DamagedError: damaged(packets[1]),
        gscl.NotGsclError: data,
        gscl.TruncatedError: b"",
    }.items():
        with pytest.raises(kind):
            decoder.add(packet)
    with pytest.raises(gscl.InvalidArgumentError):
        decoder.add_bytes(data)
    assert decoder.received == 1 and numpy.array_equal(decoder.image(), expected)


def test_decoder_repairs(repaired):
    count, packets = repaired
    decoder = gscl.Decoder()
    assert decoder.add(packets[-1]) and (decoder.size, decoder.received, decoder.drawn) == (None, 1, 0)
    for packet in packets[len(packets) - count : -1]:
        assert decoder.drawn < count and decoder.add(packet)
    assert (decoder.received, decoder.drawn, decoder.packets) == (count, count, count)
    assert numpy.array_equal(decoder.image(), gscl.decode(packets))


@pytest.mark.parametrize("bare", [False, True])
def test_decoder_of_bytes(picture, bare):
    data = gscl.encode(picture, bytes=600, effort=0, progressive=True, bare=bare)
    decoder = gscl.Decoder(bare=bare)
    qualities = []
    for start in range(0, len(data), 100):
        decoder.add_bytes(data[start : start + 100])
        assert decoder.size == (96, 64) and decoder.received == decoder.packets == 0
        assert decoder.splats == gscl.certain_splats(data[: start + 100], bare=bare)[0]
        qualities.append(psnr(picture, decoder.image()))
    assert qualities[0] < qualities[2] < qualities[-1]
    assert numpy.array_equal(decoder.image(), gscl.decode(data, bare=bare))
    with pytest.raises(gscl.InvalidArgumentError):
        decoder.add(encode(picture)[0])


def test_decoder_of_no_file():
    decoder = gscl.Decoder()
    decoder.add_bytes(b"no file at all")
    for use in lambda: decoder.splats, decoder.image:
        with pytest.raises(gscl.NotGsclError):
            use()


def test_threads_share_a_decoder(packets):
    """Each packet is new to one of the threads that add it at the same time."""
    count, rounds = 4, 40
    decoders, start, new = [gscl.Decoder() for _ in range(rounds)], threading.Barrier(count), []

    def work():
        for decoder in decoders:
            for packet in packets:
                start.wait(LIMIT)
                new.append(decoder.add(packet))

    threads = [threading.Thread(target=work) for _ in range(count)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sum(new) == rounds * len(packets)
    assert all(decoder.received == len(packets) for decoder in decoders)
    assert numpy.array_equal(decoders[-1].image(), gscl.decode(packets))


def test_pillow(picture, packets, tmp_path):
    path = tmp_path / "picture.gsclp"
    Image.fromarray(picture).save(path, packets=120, packet_count=6, packet_identity=7, effort=0)
    with Image.open(path) as image:
        assert image.format == "GSCL" and numpy.array_equal(numpy.asarray(image), gscl.decode(packets))


def test_batch(picture, tmp_path):
    """A run writes lists of packets."""
    Image.fromarray(picture).save(tmp_path / "a.png")
    summary = gscl.batch.run([str(tmp_path / "a.png")], str(tmp_path / "out"), str(tmp_path / "report"), root=str(tmp_path), effort=0, packets=120)
    assert (summary.ok, summary.failed) == (1, 0)
    assert gscl.info(tmp_path / "out/a.gscl").packets == len(encode(tmp_path / "a.png", packet_count=0))


@pytest.mark.parametrize("expected, last", [(0.0, "7 came, 7 of 10 drawn"), (0.2, r"7 came, (\d+) of \1 drawn")], ids=["without", "with"])
def test_example(picture, tmp_path, expected, last):
    """A lossy link, on which three packets of ten are lost: what comes is drawn, and repair packets make it whole."""
    Image.fromarray(picture).save(tmp_path / "picture.png")
    output = run(
        sys.executable, str(EXAMPLE), str(tmp_path / "picture.png"), str(tmp_path / "out"), "--effort", "0", "--expected", str(expected)
    )
    lines = output.splitlines()
    assert lines[0].startswith("10 packets, ") and re.search(last, lines[-1]), output
    qualities = [float(line.split()[-2]) for line in lines[1:]]
    names = sorted(path.name for path in (tmp_path / "out").iterdir())
    assert len(qualities) == len(names) == 7
    assert qualities[-1] - qualities[0] > 5
    assert psnr(picture, tmp_path / "out" / names[-1]) == pytest.approx(qualities[-1], abs=0.01)
