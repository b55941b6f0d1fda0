"""Packets: gscl encode --packets, and gscl decode of any of them."""
import base64

from images import read_png, scene
from tool import FAST, ToolTest, main

SIZE, COUNT = 120, 6
PACKETS = ("--packets", str(SIZE), "--device", "host", *FAST)
MAGIC = b"\xc7gsp"


def packets_of(listed):
    """The packets of a list.  A size of 128 and more has two bytes."""
    assert listed.startswith(MAGIC)
    packets, at = [], len(MAGIC)
    while at < len(listed):
        size = listed[at] & 127
        if listed[at] > 127:
            at += 1
            size += listed[at] << 7
        packets.append(listed[at + 1:at + 1 + size])
        at += 1 + size
    return packets


class Packets(ToolTest):
    def setUp(self):
        super().setUp()
        self.write_png("in.png", scene(96, 64))

    def names(self, count=COUNT):
        return [f"in.{number:03}.gsclp" for number in range(count)]

    def make(self, *options):
        self.gscl("encode", "in.png", *PACKETS, "--quiet", *options)

    def psnr(self, *names, options=()):
        """PSNR of what the packets draw."""
        self.gscl("decode", *names, "-o", "out.png", *options)
        return self.gscl_json("compare", "in.png", "out.png")["psnr"]

    def pixels(self, *names, options=()):
        self.gscl("decode", *names, "-o", "out.png", *options)
        return read_png(self.path("out.png").read_bytes())

    def test_each_packet_draws(self):
        self.make("--packet-count", str(COUNT))
        for name in self.names():
            self.assertIn(self.path(name).stat().st_size, range(SIZE * 3 // 4, SIZE + 1))
        self.assertFalse(self.path(self.names(COUNT + 1)[-1]).exists())
        whole = self.psnr(*self.names())
        some = self.psnr(*self.names()[1:4])
        self.assertGreater(whole, some + 1)
        for name in self.names():
            self.assertLess(self.psnr(name), whole)
        self.assertEqual(self.gscl_json("info", self.names()[0])["packets"], 1)

    def test_order_does_not_matter(self):
        self.make("--packet-count", str(COUNT))
        self.assertEqual(self.pixels(*self.names()), self.pixels(*reversed(self.names())))
        self.assertEqual(self.pixels(*self.names()[2:5]), self.pixels(*[self.names()[k] for k in (4, 2, 3)]))

    def test_one_file_and_text(self):
        self.make("--packet-count", str(COUNT))
        expected = [self.path(name).read_bytes() for name in self.names()]
        whole = self.pixels(*self.names())
        self.make("--packet-count", str(COUNT), "-o", "list.gsclp")
        self.assertEqual(packets_of(self.path("list.gsclp").read_bytes()), expected)
        self.assertEqual(self.pixels("list.gsclp"), whole)
        self.assertEqual(self.gscl_json("info", "list.gsclp")["packets"], COUNT)
        listed = self.gscl("encode", "in.png", *PACKETS, "--packet-count", str(COUNT), "--quiet", "-o", "-")
        self.assertEqual(listed, self.path("list.gsclp").read_bytes())
        text = self.gscl("encode", "in.png", *PACKETS, "--packet-count", str(COUNT), "--quiet", "--base64")
        lines = text.splitlines()
        self.assertEqual(lines, [base64.urlsafe_b64encode(packet).rstrip(b"=") for packet in expected])
        self.write("text", text)
        self.assertEqual(self.pixels("text", options=("--base64",)), whole)
        self.write("text", b"\n".join(reversed(lines[1:3])))
        self.assertEqual(self.pixels("text", options=("--base64",)), self.pixels(*self.names()[1:3]))

    def test_number_follows_from_bytes(self):
        report = self.gscl_json("encode", "in.png", *PACKETS, "--quiet", "--bytes", "500")
        sizes = [self.path(name).stat().st_size for name in self.names(5)]
        self.assertEqual(report["bytes"], sum(sizes))
        self.assertLessEqual(sum(sizes), 500)
        self.assertLessEqual(max(sizes), SIZE)
        self.assertFalse(self.path(self.names(6)[-1]).exists())

    def test_repair(self):
        self.make("--packet-count", str(COUNT), "--packet-loss", "0.2")
        whole = self.pixels(*self.names())
        self.assertEqual(self.gscl_json("info", self.names()[0])["packets"], 1)
        for lost in ((0, 1), (2, 4), (1, 5)):
            left = [name for number, name in enumerate(self.names()) if number not in lost]
            self.assertEqual(self.pixels(*left), whole)
            self.assertEqual(self.pixels(*reversed(left)), whole)
        self.refused("in.005.gsclp", "hold repair packets only", "decode", "in.005.gsclp", "-o", "out.png")

    def test_what_is_of_no_use_is_left_out(self):
        self.make("--packet-count", str(COUNT), "--packet-identity", "7")
        self.assertEqual({self.path(name).read_bytes()[0] for name in self.names()}, {7})
        few = self.pixels(*self.names()[:3])
        damaged = bytearray(self.path("in.003.gsclp").read_bytes())
        damaged[20] ^= 4
        self.write("damaged.gsclp", bytes(damaged))
        self.write("short.gsclp", self.path("in.004.gsclp").read_bytes()[:50])
        self.write("no.gsclp", b"no packet")
        self.gscl("encode", "in.png", *PACKETS, "--quiet", "--packet-count", str(COUNT), "--packet-identity", "8", "-o", "other.gsclp")
        for name, word in (("damaged.gsclp", b"damaged"), ("short.gsclp", b"damaged"), ("no.gsclp", b"damaged"),
                           ("other.gsclp", b"of another picture"), ("in.000.gsclp", b"has come before")):
            with self.subTest(name=name):
                done = self.start("decode", *self.names()[:3], name, "-o", "out.png")
                self.assertEqual(done.returncode, 0)
                self.assertIn(name.encode() + b": warning: skipped a packet", done.stderr)
                self.assertIn(word, done.stderr)
                self.assertEqual(read_png(self.path("out.png").read_bytes()), few)
        self.refused("damaged.gsclp", "is damaged, or no packet", "decode", "damaged.gsclp", "-o", "none.png")

    def test_list_that_is_cut_off(self):
        self.make("--packet-count", str(COUNT), "-o", "list.gsclp")
        self.make("--packet-count", str(COUNT))
        listed = self.path("list.gsclp").read_bytes()
        two = len(MAGIC) + sum(1 + self.path(name).stat().st_size for name in self.names()[:2])
        self.write("cut.gsclp", listed[:two + 40])
        done = self.start("decode", "cut.gsclp", "-o", "out.png")
        self.assertEqual(done.returncode, 0)
        self.assertIn(b"its last 40 bytes were skipped", done.stderr)
        self.assertEqual(read_png(self.path("out.png").read_bytes()), self.pixels(*self.names()[:2]))

    def test_wrong_options(self):
        for options in (("--packets", "39"), ("--packets", "1401"), ("--packet-count", "3"), ("--packet-loss", "0.1"),
                        ("--packets", "152", "--packet-count", "257"), ("--packets", "152", "--bare"),
                        ("--packets", "152", "--progressive"), ("--packets", "152", "--psnr", "30"),
                        ("--packets", "152", "--packet-count", "2", "--bytes", "300"),
                        ("--packets", "152", "--profile", "paper"), ("--packets", "40", "--bytes", "20000"),
                        ("--packets", "152", "--packet-identity", "199"), ("--packets", "152", "--packet-loss", "0.95")):
            with self.subTest(options=options):
                done = self.start("encode", "in.png", "--quiet", "--device", "host", *FAST, *options)
                self.assertNotEqual(done.returncode, 0)
                self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
                self.assertFalse(self.path("in.000.gsclp").exists())


if __name__ == "__main__":
    main()
