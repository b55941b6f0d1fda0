"""Lists of packets of the conformance set."""
import itertools

import gscl_decoder as gscl
from gscl_file import crc16
from scene import ALPHA, DEFAULT_STEPS, GREY, GREY_ALPHA, NORMALIZED, RGB, RGB_ALPHA, SUM, Scene

VALID, TRUNCATED, DAMAGED, NOT_GSCL = "valid", "truncated", "damaged", "not-a-gscl-file"


def listed(packets):
    return gscl.LIST_MAGIC + b"".join(gscl.varint(len(packet)) + packet for packet in packets)


def sealed(packet):
    return packet + crc16(packet).to_bytes(2, "big")


def flipped(packet, at):
    return packet[:at] + bytes([packet[at] ^ 16]) + packet[at + 1:]


def photograph(seed=200, **options):
    return Scene(**{"width": 48, "height": 32, "n": 24, **options}).fill(seed)


def packet_lists(write):
    """(name, what it is, bytes, result).  write(scene, identity, count, repairs) makes packets."""
    lists = itertools.chain(complete_lists(write), kinds(write), grids(write), orders(write), mixed_lists(write), empty_packets(write),
                            bounded(write), repaired_lists(write))
    for name, about, packets in lists:
        yield f"packets-{name}", about, listed(packets), VALID
    for name, about, data, result in refused_lists(write):
        yield f"packets-{name}", about, data, result


def complete_lists(write):
    yield "one", "a picture in one packet", write(photograph(), 7)
    for count in 2, 3, 5:
        yield f"{count}", f"{count} packets", write(photograph(), 0, count)
    yield "256-ends", "the first and the last of 256 packets", write(wide_scene(256), 255, 256)[::255]
    yield "flat", "packets without splats", write(Scene(20, 10, background=(90, 30, 200)), 7, 3)


def kinds(write):
    names = ("normalized", "alpha", "sum"), ("grey", "grey-alpha", "rgb", "rgb-alpha")
    for blend, layout in itertools.product((NORMALIZED, ALPHA, SUM), (GREY, GREY_ALPHA, RGB, RGB_ALPHA)):
        scene = photograph(210 + 4 * blend + layout, n=12, blend=blend, layout=layout, opacity=(blend + layout) % 2)
        yield f"{names[0][blend]}-{names[1][layout]}", "two packets", write(scene, 7, 2)
    yield "16", "16 bits a sample, alpha", write(photograph(230, layout=RGB_ALPHA, high=1, n=10), 7, 2)
    yield "waves", "waves", write(photograph(231, texture=1), 7, 2)
    yield "isotropic", "no anisotropy", write(photograph(232, anisotropy=0), 7, 2)
    yield "background", "a background of its own", write(photograph(233, background=(200, 100, 0)), 7, 2)
    scene = photograph(234, n=20, steps=(3, 12, 7, 9, 8, 4, 3), pivot=40)
    yield "steps", "steps that are not the default, and a pivot far from the typical axis", write(scene, 7, 2)
    steps = DEFAULT_STEPS[:3] + (6, 4) + DEFAULT_STEPS[5:]
    yield "fine-steps", "four of 64 packets, in which 10 splats or more have the default steps of 640", \
        write(Scene(256, 256, n=700, steps=steps).fill(235, (4, 12)), 7, 64)[:4]


def wide_scene(count):
    """A splat in every so many cells, in classes with cells enough for each packet to have some of its own."""
    scene = Scene(600, 20, n=40, layout=GREY, anisotropy=0, steps=(6, 0, 4, 5, 3, 4, 3), background=(90,))
    for i in range(40):
        scene.add(4 + i % 3, x=(37 * i % count) / count, y=i * 7 % 20 / 20, luma=i % 16)
    return scene


def grids(write):
    yield "portrait", "classes that are divided along y", write(photograph(240, width=20, height=60), 7, 4)
    yield "square", "a square, whose classes are divided along x", write(photograph(241, width=40, height=40), 7, 4)
    thin = photograph(242, width=300, height=2, n=40)
    yield "thin", "thirteen packets of a thin picture, of which most classes have few cells", write(thin, 7, 13)
    yield "tiny", "more packets than most classes have cells", write(photograph(243, width=5, height=4, n=12), 7, 4)
    for name, places in ("column", dict(width=61, height=41)), ("row", dict(width=41, height=61)):
        scene = Scene(n=24, anisotropy=0, **places)
        for i in range(24):
            scene.add(6 + i % 6, 0, 0, *[(.999, i / 24), (i / 24, .999)][name == "row"], 2 + i % 8, i % 5, -(i % 4))
        yield f"last-{name}", f"splats in the last {name} of cells, each in all packets that have it", \
            write(scene, 7, 5, 0, "everywhere")
    yield "large", "the largest splats in all packets, which count once", \
        write(Scene(48, 32, n=8).fill(244, (18, 24)), 7, 3, 0, "everywhere")
    yield "equal", "equal splats in one cell, which count once", write(Scene(48, 32, n=6).add(8, 2, 1, .3, .4, 9, count=6), 7, 2)
    far = Scene(400, 30, n=300, layout=GREY, anisotropy=0, steps=(6, 0, 4, 5, 3, 4, 3))
    yield "priors", "grids of more than 128 cells, split by the splats before", write(far.fill(245, (0, 20)), 7, 2)


def orders(write):
    packets = write(photograph(), 7, 5)
    yield "missing", "the first and the fourth of five packets are missing", packets[1:3] + packets[4:]
    yield "last", "the last of five packets", packets[4:]
    yield "unordered", "five packets in another order", [packets[i] for i in (3, 0, 4, 1, 2)]
    yield "repeated", "each packet twice or more", packets[2:] + packets + packets[:2]
    scene = Scene(48, 32, n=6, blend=ALPHA, opacity=1)
    for i in range(6):
        scene.add(22, 1, 0, .5, .5, 4 + 2 * i, i % 3, -(i % 2), opacity=i % 4)
    yield "alpha-cell", "splats in one cell, by several packets, in another order", write(scene, 7, 3)[::-1]
    yield "alpha-unordered", "the blend alpha, whose splats are drawn in the order of the whole picture", \
        write(photograph(250, blend=ALPHA, opacity=1), 7, 4)[::-1]
    other = write(photograph(251), 7, 5)
    yield "numbers", "packets of another picture that looks the same, whose numbers have been there", packets[:3] + other[2::-1]
    yield "joined", "packets of another picture that looks the same, with other numbers", packets[:2] + other[2:]


def mixed_lists(write):
    packets = write(photograph(), 7, 4)
    yield "damaged", "one packet with a changed bit", [packets[0], flipped(packets[1], 9), *packets[2:]]
    yield "damaged-first", "a changed bit in the first packet, which also comes intact", [flipped(packets[0], 5), *packets]
    yield "identity", "packets of another identity among them", mixed(packets, write(photograph(252), 8, 4))
    yield "size", "packets of another size among them", mixed(packets, write(photograph(252, width=47), 7, 4))
    yield "kind", "packets of another kind among them", mixed(packets, write(photograph(252, texture=1), 7, 4))
    yield "number", "packets of another division among them", mixed(packets, write(photograph(), 7, 5))
    yield "other-steps", "packets with other steps, which take their numbers", \
        mixed(packets, write(photograph(252, steps=(6, 8, 4, 6, 3, 4, 3)), 7, 4))
    yield "other-pivot", "packets with another pivot", mixed(packets, write(photograph(252, pivot=9), 7, 4))
    yield "other-background", "packets with another background", mixed(packets, write(photograph(252, background=(1, 2, 3)), 7, 4))
    yield "long-picture", "a packet with a byte too many, with a check that matches", [sealed(packets[0][:-2] + b"\0"), *packets]
    yield "short-picture", "a packet with a byte less, with a check that matches", [sealed(packets[0][:-3]), *packets[1:]]
    yield "no-header", "a packet that ends in its header, with a check that matches", [sealed(packets[3][:3]), *packets]
    yield "short", "packets of 0 to 3 bytes", [b"", b"\7", b"\7\7", sealed(b"\7"), *packets[:2]]
    yield "size-beyond", "a last packet that is cut off", packets[:3] + [packets[3] + b"\x7F"]


def mixed(packets, others):
    return [packet for pair in zip(packets, others[1:] + others[:1]) for packet in pair]


def empty_packets(write):
    few = Scene(60, 40, n=3, background=(10, 120, 200)).add(8, 2, 1, .1, .1, 9).add(9, 3, 1, .5, .5, 12).add(7, 2, 2, .8, .6, 4)
    packets = write(few, 7, 6)
    yield "empty", "packets with and without splats", packets
    yield "empty-first", "packets without splats first", sorted(packets, key=len)
    yield "empty-only", "a packet without splats of a picture that has some", sorted(packets, key=len)[:1]
    empty, some = write(Scene(48, 32, background=(90, 30, 200)), 7, 3), write(photograph(254), 7, 3)
    yield "background-of-splats", "a packet without splats has another background than those after it", [empty[0], *some[1:]]
    yield "background-of-first", "packets without splats and of several backgrounds", \
        [empty[1], write(Scene(48, 32, background=(1, 2, 3)), 7, 3)[0]]


def bounded(write):
    """The limit of the work, which is that of 320 splats that cover 1024 by 1024 pixels."""
    large = lambda luma, count: Scene(1024, 1024, n=count, anisotropy=0, layout=GREY, pivot=63).add(63, luma=luma, count=count)
    packets = [write(large(luma, 4 * count), 7, 4)[k] for k, (luma, count) in enumerate(((3, 150), (5, 150), (9, 80), (12, 10)))]
    yield "work", "a packet with which there would be too much work, before one that is small enough", packets


def repaired_lists(write):
    packets = write(photograph(), 7, 5, 3)
    first, repairs = packets[:5], packets[5:]
    yield "repair", "two of five packets are lost, and made up for", [*first[:1], *first[2:4], *repairs[1:]]
    yield "repair-first", "repair packets come first", [*repairs, first[3], first[0]]
    yield "repair-one", "a single packet, and repair packets for all others", write(photograph(), 7, 4, 3)[3:]
    yield "repair-all", "none is lost", packets
    yield "repair-few", "more packets are lost than there are repair packets", [*first[:2], *repairs[:2]]
    yield "repair-repeated", "a repair packet twice does not make up for two", [*first[:3], repairs[0], repairs[0]]
    yield "repair-damaged", "a repair packet with a changed bit", [*first[:3], repairs[0], flipped(repairs[1], 7), repairs[2]]
    yield "repair-identity", "repair packets of another identity", [*first[:3], *write(photograph(253), 8, 5, 2)[5:]]
    yield "repair-other", "repair packets of another picture of the same identity", [*first[:3], *write(photograph(253), 7, 5, 2)[5:]]
    yield "repair-short", "a repair packet that is shorter than a packet", [*first[:4], check_of_repair(repairs[0][:20])]
    yield "repair-length", "a repair packet of another length, which is skipped", \
        [*first[:4], repairs[1], check_of_repair(repairs[0][:-2] + b"\0")]
    yield "repair-number", "a repair packet with the number of a packet, which is skipped", \
        [*first[:4], check_of_repair(repairs[0][:1] + b"\4" + repairs[0][2:-2])]
    yield "repair-same-number", "two repair packets with the same number, of which the first counts", \
        [*first[:3], repairs[0], check_of_repair(repairs[0][:2] + repairs[1][2:-2]), repairs[1]]
    yield "repair-lengths", "a repair packet of another length between those that count", \
        [*first[:3], repairs[0], check_of_repair(repairs[1][:-2] + b"\0"), repairs[2]]
    yield "repair-number-first", "a repair packet of another length and with the number of a packet comes first", \
        [check_of_repair(repairs[0][:1] + b"\4" + repairs[0][2:-2] + b"\0"), *first[:4], repairs[0]]
    few = write(Scene(60, 40, n=1, background=(10, 120, 200)).add(8, 2, 1, .1, .1, 9), 7, 4, 3)
    lone = min(few[:4], key=len)
    yield "repair-empty", "of the picture only a packet without splats, and repair packets for all others", [lone, *few[4:]]
    yield "repair-zero", "a lost packet that ends with 0", zero_ended(write)
    yield "repair-255", "a repair packet with the largest number", [*first[:4], write(photograph(), 7, 5, 251)[255]]


def check_of_repair(packet):
    return packet + (crc16(packet) ^ 0xFFFF).to_bytes(2, "big")


def zero_ended(write):
    """A list that lacks a packet whose last byte is 0 and that is shorter than another."""
    for identity in range(1, 199):
        packets = write(photograph(), identity, 3, 1)
        for k, packet in enumerate(packets[:3]):
            if packet[-1] == 0 and len(packet) < max(map(len, packets[:3])):
                return packets[:k] + packets[k + 1:]
    raise ValueError("no packet ends with 0")


def refused_lists(write):
    packets = write(photograph(), 7, 3, 2)
    whole = listed(packets[:3])
    yield "none", "a list without packets", gscl.LIST_MAGIC, TRUNCATED
    yield "cut", "a list that is cut in its first packet", whole[:len(packets[0])], TRUNCATED
    yield "cut-later", "a list that is cut in its last packet", whole[:-9], VALID
    yield "size-cut", "a list that is cut in the first size", gscl.LIST_MAGIC + b"\x81", TRUNCATED
    yield "size-long", "a size with a byte too many", gscl.LIST_MAGIC + bytes([len(packets[0]) | 128, 0]) + packets[0], TRUNCATED
    yield "size-4", "a size of four bytes", gscl.LIST_MAGIC + b"\x81\x80\x80\1" + packets[0], TRUNCATED
    yield "size-long-later", "a size with a byte too many, which ends the list", \
        listed(packets[:1]) + bytes([len(packets[1]) | 128, 0]) + packets[1], VALID
    yield "all-damaged", "a changed bit in each packet", listed(flipped(packet, 9) for packet in packets[:3]), DAMAGED
    yield "repairs-only", "repair packets alone", listed(packets[3:]), DAMAGED
    yield "empty-packet", "a packet of 0 bytes", gscl.LIST_MAGIC + b"\0", DAMAGED
    yield "identity-199", "the identity that no picture has", listed([sealed(b"\xC7" + packets[0][1:-2])]), DAMAGED
    yield "not-valid", "a packet with a byte too many, with a check that matches", listed([sealed(packets[0][:-2] + b"\0")]), DAMAGED
    yield "magic", "another magic", b"\xC7gsq" + whole[4:], NOT_GSCL
    file = write(photograph(), 7)[0]
    yield "file", "a packet as a file, without a list", file, NOT_GSCL
