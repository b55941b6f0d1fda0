"""Wrong inputs: gscl prints one line, returns the documented exit code, and leaves no files."""
import os
import resource
import struct
import subprocess
import unittest

from gscl_file import contained, header
from images import (PNG_SIGNATURE, Image, exr_bytes, png_bytes, png_chunk, png_header, pnm_bytes, scene, tiff_bytes)
from tool import FAST, GSCL, NO_OPENCL, OPENCL, ToolTest, main



class Images(ToolTest):
    def bad(self, name, data, message):
        self.write(name, data)
        self.refused(name, message, "encode", name, "-o", "out.gscl", *FAST)

    def test_not_an_image(self):
        self.bad("text.png", b"no image at all, only text\n", "is not an image")
        self.bad("zeros.jpg", bytes(1000), "is not an image")
        self.bad("file.gscl", contained(header(4, 4, 0).finish()), "is a gscl file, not an image")

    def test_empty_file(self):
        self.bad("empty.png", b"", "is empty; an image is expected")

    def test_missing_and_folder(self):
        self.refused("missing.png", "cannot be opened: No such file", "encode", "missing.png")
        os.mkdir(self.path("folder.png"))
        self.refused("folder.png", "is a folder; name its files, as folder.png/\\*", "encode", "folder.png")

    def test_empty_name(self):
        self.refused("''", "cannot be opened: No such file", "encode", "", "-o", "out.gscl")
        self.refused("''", "cannot be opened: No such file", "decode", "", "-o", "out.png")

    def test_truncated_png(self):
        data = png_bytes(scene(30, 20))
        for size in (8, 20, 33, 40, 60, len(data) // 2, len(data) - 13, len(data) - 1):
            with self.subTest(size=size):
                self.bad("in.png", data[:size], "truncated|is not an image")

    def test_damaged_png(self):
        data = bytearray(png_bytes(scene(30, 20)))
        data[len(data) // 2] ^= 0x10
        self.bad("in.png", bytes(data), "CRC|[Ii]ncorrect|invalid")

    def test_chunk_longer_than_its_file(self):
        """libpng allocates and clears a chunk before it reads it."""
        data = png_bytes(scene(30, 20))
        chunk = struct.pack(">I4s", 1 << 30, b"iTXt") + b"XML:com.adobe.xmp"
        self.write("in.png", data[:33] + chunk + data[33:])
        with subprocess.Popen([GSCL, "encode", self.path("in.png")], stderr=subprocess.PIPE) as process:
            self.assertIn(b"truncated", process.stderr.read())
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
        self.assertEqual(process.returncode, 1)
        self.assertLess(usage.ru_maxrss, 200 << 10)  # KiB

    def test_truncated_jpeg_tiff_exr_pnm(self):
        self.encode(scene(60, 40))
        self.gscl("decode", "in.gscl", "-o", "out.jpg")
        plane = [0.5] * 2400
        files = {"in.jpg": self.path("out.jpg").read_bytes(), "in.tif": tiff_bytes(scene(60, 40)),
                 "in.exr": exr_bytes(60, 40, {"R": plane, "G": plane, "B": plane}), "in.ppm": pnm_bytes(scene(60, 40))}
        os.remove(self.path("in.gscl"))
        for name, data in files.items():
            for part in (0.1, 0.5, 0.98):
                with self.subTest(name=name, part=part):
                    self.bad(name, data[:int(part * len(data))], "truncated|is not an image|cannot be read")

    def test_zero_size(self):
        rows = png_chunk(b"IDAT", b"") + png_chunk(b"IEND", b"")
        self.bad("in.png", PNG_SIGNATURE + png_header(0, 5, 8, 2) + rows, "zero|invalid|Invalid")
        self.bad("in.ppm", b"P6\n0 5\n255\n", "0 x 5 pixels|is not an image")
        self.bad("in.tif", tiff_bytes(Image(0, 4, 3, 8, [])), "0 x 4 pixels|is not an image")

    def test_too_large_is_refused_before_pixels_are_read(self):
        """Both files declare gigabytes and contain no pixels."""
        self.bad("in.png", PNG_SIGNATURE + png_header(20000, 3, 8, 2) + png_chunk(b"IDAT", b""),
                 "is 20000 x 3 pixels; 1 x 1 to 16384 x 16384")
        self.bad("in.ppm", b"P6\n3 16385\n255\n", "is 3 x 16385 pixels; 1 x 1 to 16384 x 16384")

    def test_png_bomb(self):
        bomb = PNG_SIGNATURE + png_header(16384, 16384, 16, 6) + png_chunk(b"IDAT", bytes(100)) + png_chunk(b"IEND", b"")
        self.write("in.png", bomb)
        self.refused("in.png", "truncated", "encode", "in.png", preexec_fn=limit_memory(512 << 20))

    def test_not_finite(self):
        for value, message in ((float("nan"), "NaN"), (float("inf"), "infinite")):
            for name in ("R", "A"):
                with self.subTest(value=value, name=name):
                    planes = {channel: [0.5] * 100 for channel in "RGBA"}
                    planes[name][55] = value
                    self.bad("in.exr", exr_bytes(10, 10, planes), f"{message}.*finite")


def limit_memory(size):
    return lambda: resource.setrlimit(resource.RLIMIT_AS, (size, size))


# A prefix of gscl: mounts a small file system on disk/ in a namespace of its own, and lists the files left there.
NAMESPACE = ("unshare", "--mount", "--user", "--map-root-user", "sh", "-c")
SMALL_DISK = (*NAMESPACE, 'mount -t tmpfs -o size=64k tmpfs disk && "$@"; code=$?; ls -A disk; exit $code', "sh")
FULL_DISK = (*NAMESPACE, 'mount -t tmpfs -o size=64k tmpfs disk && head -c 65536 /dev/zero >disk/.zeros && "$@"; code=$?;'
             ' rm disk/.zeros; ls -A disk; exit $code', "sh")


def may_mount():
    try:
        return subprocess.run([*NAMESPACE, "mount -t tmpfs tmpfs /mnt"], capture_output=True).returncode == 0
    except OSError:
        return False


class Outputs(ToolTest):
    def setUp(self):
        super().setUp()
        self.encode(scene(40, 30))
        self.write_png("in.png", scene(40, 30))

    def test_folder_that_does_not_exist(self):
        for arguments in (("encode", "in.png", "-o", "missing/out.gscl"), ("decode", "in.gscl", "-o", "missing/out.png"),
                          ("draw", "in.gscl", "-o", "missing/out.png"), ("decode", "in.gscl", "-o", "missing/out.tif")):
            with self.subTest(arguments=arguments):
                self.refused(arguments[-1], "cannot be written: No such file", *arguments)
        self.write("file", b"")
        self.refused("file", "cannot be made a folder: Not a directory", "encode", "in.png", "--out-dir", "file/sub")

    def test_output_is_a_folder(self):
        os.mkdir(self.path("out.png"))
        self.refused("out.png", "cannot be written: Is a directory", "decode", "in.gscl", "-o", "out.png")

    @unittest.skipIf(os.geteuid() == 0, "root has all permissions")
    def test_no_permission(self):
        os.mkdir(self.path("closed"), 0o555)
        self.refused("closed/out.gscl", "cannot be written: Permission denied", "encode", "in.png", "-o",
                     "closed/out.gscl")

    def test_output_would_overwrite_the_input(self):
        os.link(self.path("in.png"), self.path("link.gscl"))
        self.path("soft.png").symlink_to("in.gscl")
        self.refused("encode", "link.gscl would overwrite the input", "encode", "in.png", "-o", "link.gscl", code=2)
        self.refused("encode", "in.png would overwrite the input", "encode", "in.png", "-o", "./in.png", code=2)
        self.refused("decode", "soft.png would overwrite the input", "decode", "in.gscl", "-o", "soft.png", code=2)

    def test_full_disk(self):
        """Every write to /dev/full fails, also through a symbolic link."""
        message = "cannot be written: No space left on device"
        self.path("full.png").symlink_to("/dev/full")
        self.refused("/dev/full", message, "encode", "in.png", "-o", "/dev/full", *FAST)
        self.refused("full.png", message, "decode", "in.gscl", "-o", "full.png")
        self.refused("full.png", message, "draw", "in.gscl", "-o", "full.png")

    def test_standard_output_on_a_full_disk(self):
        for arguments in (("encode", "in.png", "-o", "-", *FAST), ("decode", "in.gscl", "-o", "-"), ("info", "in.gscl"),
                          ("info", "in.gscl", "--json"), ("compare", "in.png", "in.png"), ("devices",), ("help",)):
            with self.subTest(arguments=arguments), open("/dev/full", "wb") as full:
                self.refused("standard output", "cannot be written: No space left on device", *arguments, stdout=full,
                             stderr=subprocess.PIPE)

    @unittest.skipUnless(may_mount(), "this process cannot mount a file system")
    def test_disk_that_fills_up(self):
        """A write that fails half-way, for every writer.  The prefix lists files that are left."""
        os.mkdir(self.path("disk"))
        for suffix in ("png", "ppm", "tif", "exr", "bmp", "tga", "jpg"):
            with self.subTest(suffix=suffix):
                self.refused(f"disk/out.{suffix}", "cannot be written", "decode", "in.gscl", "-o", f"disk/out.{suffix}",
                             "--size", "1500x1200", prefix=SMALL_DISK)
        self.refused("disk/out.gscl", "cannot be written: No space left", "encode", "in.png", "-o", "disk/out.gscl",
                     *FAST, prefix=FULL_DISK)

    def test_closed_pipe(self):
        self.encode(scene(200, 150))
        reader, writer = os.pipe()
        os.close(reader)  # before the tool starts, whose output would fit into the pipe
        done = self.start("decode", "in.gscl", "-o", "-", stdout=writer, stderr=subprocess.PIPE)
        os.close(writer)
        self.assertEqual((done.returncode, done.stderr), (128 + 13, b""))


class Files(ToolTest):
    """Invalid gscl files."""

    def bad(self, data, message):
        self.write("bad.gscl", data)
        self.refused("bad.gscl", message, "info", "bad.gscl")
        self.refused("bad.gscl", message, "decode", "bad.gscl", "-o", "out.png")
        self.refused("bad.gscl", message, "draw", "bad.gscl", "-o", "out.png")

    def test_not_gscl(self):
        for data in (b"", b"gs", b"hello, world", png_bytes(scene(5, 5)), bytes(100)):
            with self.subTest(data=data[:8]):
                self.bad(data, "not a gscl file")

    def test_newer_version(self):
        data = self.encode(scene(20, 20))
        for version in (3, 15):
            with self.subTest(version=version):
                self.bad(data[:4] + bytes([version]) + data[5:], "newer format version")

    def test_truncated(self):
        data = self.encode(scene(20, 20))
        for size in (4, 5, 8, 12, 13, 20, len(data) // 2, len(data) - 1):
            with self.subTest(size=size):
                self.bad(data[:size], "incomplete|damaged")

    def test_surplus_bytes(self):
        self.bad(self.encode(scene(20, 20)) + b"\0", "damaged|checksum")

    def test_flipped_bytes(self):
        data = self.encode(scene(20, 20))
        for at in (4, 6, 9, 11, 14, 30, len(data) - 1):
            with self.subTest(at=at):
                self.bad(data[:at] + bytes([data[at] ^ 0x55]) + data[at + 1:], "damaged|incomplete|newer")

    def test_impossible_sizes(self):
        """Files whose check matches, and which ask for much more than they hold."""
        cases = {"largest": header(16384, 16384, 1 << 20), "many": header(9, 9, (1 << 20) - 1),
                 "codebooks": header(9, 9, 1 << 20, codebook=True)}
        for name, picture in cases.items():
            with self.subTest(name=name):
                self.write("bad.gscl", contained(picture.finish()))
                for command in (("info",), ("decode", "-o", "out.png", "--max-pixels", 1 << 28, "--max-work", 1 << 60)):
                    self.refused("bad.gscl", "breaks a rule", *command, "bad.gscl")

    def test_blocks(self):
        data = self.encode(scene(20, 20))
        picture = data[5:-2]
        self.bad(contained(picture, before=b"\xdf\x01x"), "block that must be understood")
        self.bad(contained(picture, after=b"\xff\x01x"), "block that must be understood")
        self.bad(contained(picture, before=b"\x9f\x02x"), "breaks a rule")
        self.bad(contained(picture, version=66), "breaks a rule")
        self.write("good.gscl", contained(picture, before=b"\x9f\x01x", after=b"\xbf\x01x"))
        self.gscl("decode", "good.gscl", "-o", "out.png")

    def test_areas_outside(self):
        self.encode(scene(30, 20))
        self.refused("in.gscl", "has no area 20,0,11,5; the image is 30 x 20", "decode", "in.gscl", "-o", "out.png",
                     "--crop", "20,0,11,5")
        self.refused("in.gscl", "wider or higher than 16384", "decode", "in.gscl", "-o", "out.png", "--scale", "1000")
        self.encode(scene(300, 20))
        self.refused("in.gscl", "wider or higher than 16384", "draw", "in.gscl", "-o", "out.png", "--scale", "64")


class Budgets(ToolTest):
    def test_too_small(self):
        self.write_png("in.png", scene(30, 20))
        error = self.refused("in.png", r"too small; the smallest .* \d+ bytes", "encode", "in.png", "--bytes", "5", *FAST)
        smallest = int(error.split()[-2])
        self.refused("in.png", "too small", "encode", "in.png", "--bytes", smallest - 1, *FAST)
        self.gscl("encode", "in.png", "--bytes", smallest, *FAST)
        self.assertEqual(self.path("in.gscl").stat().st_size, smallest)

    def test_unreachable_quality(self):
        self.write_png("in.png", scene(30, 20))
        self.refused("in.png", "dB", "encode", "in.png", "--psnr", "100", *FAST)
        self.refused("in.png", r"a SSIMULACRA 2 of 99\.90 cannot be reached; the best found is [\d.]+$", "encode", "in.png",
                     "--ssimulacra2", "99.9", *FAST)

    def test_too_small_for_the_measure(self):
        self.write_png("in.png", scene(40, 7))
        self.refused("in.png", "cannot be measured of 40x7 pixels, only from 8x8 on", "encode", "in.png", "--ssimulacra2",
                     "30", *FAST)


class OpenCL(ToolTest):
    def setUp(self):
        super().setUp()
        self.encode(scene(16, 16))
        self.write_png("in.png", scene(16, 16))

    def test_no_platform(self):
        for arguments in (("encode", "in.png", "-o", "out.gscl"), ("draw", "in.gscl", "-o", "out.png"),
                          ("decode", "in.gscl", "-o", "out.png")):
            with self.subTest(arguments=arguments):
                self.refused("OpenCL", "no OpenCL.*install", *arguments, "--mapping", "gpu", env=NO_OPENCL)
                self.refused("0.0", "no OpenCL device was found.*install", *arguments, *OPENCL, env=NO_OPENCL)
                self.refused("pocl", r'no device matches "pocl"; there is host \([^)]*\)$', *arguments, "--device", "pocl",
                             env=NO_OPENCL)
                self.gscl(*arguments, "--mapping", "cpu", env=NO_OPENCL)
                self.path(arguments[-1]).unlink()

    def test_host_has_no_mapping_for_gpus(self):
        self.refused("host", "the CPU mapping; choose an OpenCL device", "encode", "in.png", "-o", "out.gscl", "--device",
                     "host", "--mapping", "gpu")

    def test_commands_that_need_no_opencl(self):
        self.gscl("info", "in.gscl", env=NO_OPENCL)
        self.gscl("encode", "in.png", "-o", "out.gscl", *FAST, env=NO_OPENCL)
        self.gscl("decode", "in.gscl", "-o", "out.png", "--scale", "100", env=NO_OPENCL)
        self.gscl("draw", "in.gscl", "-o", "out.png", env=NO_OPENCL)
        self.assertEqual(["host"], [device["id"] for device in self.gscl_json("devices", env=NO_OPENCL)])
        self.gscl("compare", "in.png", "in.png", env=NO_OPENCL)

    def test_unknown_device(self):
        for device in ("9.9", "no such device", "0.99"):
            with self.subTest(device=device):
                self.refused(device, "no .*device", "decode", "in.gscl", "-o", "out.png", "--device", device)
                self.refused(device, "no .*device", "encode", "in.png", "-o", "out.gscl", "--device", device)


class Usage(ToolTest):
    """Wrong command lines: exit code 2."""

    def wrong(self, message, command, *arguments):
        self.refused(command, message, command, *arguments, code=2)

    def test_commands(self):
        self.wrong("is not a command; 'gscl help' lists", "encoed", "in.png")

    def test_options(self):
        self.wrong("unknown option --fast; 'gscl encode -h'", "encode", "in.png", "--fast")
        self.wrong("unknown option -z; 'gscl decode -h'", "decode", "-z", "in.gscl")
        self.wrong("--bytes lacks its value", "encode", "in.png", "--bytes")
        self.wrong("-o lacks its value", "decode", "in.gscl", "-o")

    def test_operands(self):
        for command in ("encode", "decode", "info", "draw"):
            self.wrong("an input is missing; usage: gscl", command)
        self.wrong("an input is missing", "compare", "a.png")
        self.wrong("too many inputs", "info", "a.gscl", "b.gscl")
        self.wrong("a bare file is decoded alone", "decode", "a.gscl", "b.gscl", "--bare", "-o", "out.png")
        self.wrong("too many inputs", "devices", "0.0")
        self.wrong("the output is missing", "decode", "a.gscl")
        self.wrong("-o is missing", "draw", "a.gscl")

    def test_values(self):
        for option, value, message in (
                ("bytes", "0", "a whole number from 1 to 4294967295"), ("bytes", "-5", "a whole number from 1"),
                ("bytes", "12x", "a whole number"), ("bytes", " 12", "a whole number"), ("bytes", "", "a whole number"),
                ("bytes", "99999999999999999999", "a whole number"), ("effort", "10", "from 0 to 9"),
                ("bpp", "0", "from 0.0001 to 64"), ("bpp", "nan", "a number"), ("bpp", "inf", "a number"), ("bpp", "-nan", "a number"), ("bpp", "65", "from 0.0001 to 64"),
                ("psnr", "0.5", "from 1 to 100"), ("ssimulacra2", "-100.1", "from -100 to 100"),
                ("ssimulacra2", "101", "from -100 to 100"), ("ssimulacra2", "nan", "a number"), ("splats", "1048577", "from 1 to 1048576"),
                ("seed", "18446744073709551616", "from 0 to 18446744073709551615"),
                ("blend", "Alpha", "one of auto, normalized, alpha, sum"), ("profile", "", "one of default, paper"),
                ("loss", "l3", r"one of auto, l1, l1\+ssim, l2"), ("tune", "vmaf", "one of auto, psnr, ssim, visual"),
                ("mapping", "fpga", "one of auto, cpu, gpu"),
                ("codebook", "1", "from 2 to 1024"), ("threads", "0", "from 1 to 1024"), ("threads", "2000", "from 1 to 1024"),
                ("out-dir", "", "cannot be ''")):
            with self.subTest(option=option, value=value):
                self.wrong(f"--{option} cannot be '{value}'; it takes.*{message}|cannot be ''", "encode", "in.png",
                           f"--{option}", value)

    def test_sizes_and_areas(self):
        for option, value in (("size", "0x5"), ("size", "x0"), ("size", "5x"), ("size", "5x16385"), ("size", "5x5x5"),
                              ("crop", "1,2,3"), ("crop", "1,2,0,4"), ("crop", "1,2,3,4,5"), ("crop", "-1,2,3,4"),
                              ("scale", "0"), ("scale", "-1"), ("depth", "12")):
            with self.subTest(option=option, value=value):
                self.wrong(f"--{option} cannot be '{value}'", "decode", "in.gscl", "-o", "out.png", f"--{option}", value)

    def test_contradictions(self):
        targets = (("--bytes", "9"), ("--bpp", "1"), ("--psnr", "30"), ("--ssimulacra2", "30"), ("-q", "30"),
                   ("--splats", "9"))
        for a in targets:
            for b in targets:
                if a != b:
                    self.wrong("--bytes, --bpp, --psnr, --ssimulacra2, --quality and --splats exclude", "encode", "in.png",
                               *a, *b)
        self.wrong("-o and --out-dir exclude", "encode", "in.png", "-o", "a", "--out-dir", "b")
        self.wrong("-o names one file but there are 2 inputs", "encode", "a.png", "b.png", "-o", "a.gscl")
        self.wrong("--codebook .* --profile paper", "encode", "in.png", "--codebook", "16")
        self.wrong("--quiet and -v exclude", "encode", "in.png", "--quiet", "-v")
        self.wrong("both write to standard output", "encode", "in.png", "--json", "-o", "-")
        self.wrong("--trace is part of the JSON report", "encode", "in.png", "--trace")
        self.wrong("with standard input, give -o", "encode", "-")
        self.wrong("--scale and --size exclude", "decode", "a.gscl", "-o", "a.png", "--scale", "2", "--size", "3x3")

    def test_profile_and_blend_that_exclude_each_other(self):
        self.write_png("in.png", scene(16, 16))
        for blend in ("normalized", "sum"):
            self.refused("in.png", "paper profile", "encode", "in.png", "--profile", "paper", "--blend", blend, code=2)
        self.refused("in.png", "layers", "encode", "in.png", "--profile", "paper", "--progressive", code=2)

    def test_messages_stay_on_one_line(self):
        name = "two\nlines\x1b[31m.png"
        self.refused("two lines [31m.png", "cannot be opened", "encode", name)


if __name__ == "__main__":
    main()
