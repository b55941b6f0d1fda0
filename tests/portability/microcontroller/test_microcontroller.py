"""Decodes files by rows on microcontrollers that QEMU emulates: test_microcontroller.py CODES [--write | TEST...]

CODES is the program of tests/conformance/codes.c, whose pictures of the device "host" are the expected ones.  Prints TAP, and the
table of README.md, into which --write puts it.  Skipped where Debian's gcc-arm-none-eabi, libnewlib-arm-none-eabi or
qemu-system-arm is missing.
"""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[2]
sys.path[:0] = [str(ROOT / "tests/conformance"), str(ROOT / "tests/cli")]

from codes import Codes
from tool import main

COMPILER, EMULATOR = "arm-none-eabi-gcc", "qemu-system-arm"
BOARDS = {  # of QEMU, and the processor on each
    "mps2-an386": ("Cortex-M4F", ["-mcpu=cortex-m4", "-mfpu=fpv4-sp-d16"]),
    "mps2-an500": ("Cortex-M7", ["-mcpu=cortex-m7", "-mfpu=fpv5-sp-d16"]),
}
# newlib's uint32_t is a long, so that the formats of messages, which are not linked, are wrong.
FLAGS = """-std=c99 -O2 -mthumb -mfloat-abi=hard -DNDEBUG -DGSCL_SINGLE_PRECISION -DGSF_SMALL_READER -ffp-contract=fast -fno-math-errno
    -ffunction-sections -fdata-sections -Wall -Wextra -Wdouble-promotion -Werror -Wno-format
    -nostartfiles --specs=nano.specs -Wl,--gc-sections""".split()
DECODER = """decode/blend.c decode/coded_image.c decode/decode_rows.c decode/dequantise.c decode/draw_rows.c decode/format_result.c decode/packet_repair.c
    decode/frame.c decode/output.c decode/resize.c image/image.c runtime/elementary_single.c runtime/struct_size.c software/canvas.c
    software/projection.c software/samples.c software/strips.c""".split()
SOURCES = [*sorted((ROOT / "format").glob("*.c")), *(ROOT / "host/lib" / name for name in DECODER), *sorted(HERE.glob("*.c"))]
INCLUDES = [ROOT, ROOT / "host/lib", ROOT / "host/include"]
# Arithmetic of doubles and its conversions, memory of the C library, formatted texts.
UNWANTED = re.compile(r"__aeabi_(d\w*|c?d\w*|\w*2d)|_?(malloc|calloc|realloc|free)(_r)?|_sbrk(_r)?|\w*printf\w*")

FILES = sorted((HERE / "files").iterdir(), key=lambda path: path.stat().st_size)
STRIP, WHOLE = 16, 9999  # rows
CLOCK = 240e6  # instructions a second
MAX_CODE, MAX_MEMORY, MAX_MEMORY_WITH_WHOLE, MAX_SECONDS, MAX_STACK = 64000, 64000, 300000, 2, 5500
TABLE = re.compile(r"(?<=<!-- table -->\n).*(?=<!-- end -->)", re.DOTALL)
HEADING = """| processor | file, bytes | splats | code, bytes | memory, bytes | instructions | of them to read | s at 240 MHz |
|---|---|---|---|---|---|---|---|
"""


def build(flags, program):
    subprocess.run([COMPILER, *flags, *FLAGS, *(f"-I{path}" for path in INCLUDES), "-T", str(HERE / "layout.ld"),
                    *map(str, SOURCES), "-o", str(program), "-lm"], check=True)


def code_size(program):
    """Bytes of instructions, constants and initial values."""
    text, data, *_ = subprocess.run(["arm-none-eabi-size", program], check=True, capture_output=True, text=True).stdout.splitlines()[1].split()
    return int(text) + int(data)


def symbols(program):
    return subprocess.run(["arm-none-eabi-nm", "-P", program], check=True, capture_output=True, text=True).stdout.split("\n")


class Run:
    """A decode on a board: what the program prints, and the samples."""

    def __init__(self, board, program, path, rows):
        folder = program.parent
        shutil.copy(path, folder / "in")
        words = ["decode_file", str(rows), "in", "out"]
        command = [EMULATOR, "-M", board, "-kernel", str(program), "-display", "none", "-monitor", "none", "-serial", "none",
                   "-icount", "shift=0", "-semihosting-config", ",".join(["enable=on,target=native", *(f"arg={word}" for word in words)])]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=600)
        printed = done.stdout + done.stderr  # the semihosting console is one of the two
        self.succeeded, self.printed = done.returncode == 0, printed
        self.numbers = {name: int(number) for name, number in re.findall(r"^(\w+) (\d+)$", printed, re.MULTILINE)}
        self.samples = (folder / "out").read_bytes()

    def memory(self):
        """All that the decode takes: variables, stack, the file, and the memory that it is lent, with the strip in it."""
        return sum(self.numbers[name] for name in ("variables", "stack", "file", "memory"))

    def seconds(self):
        return self.numbers["instructions"] / CLOCK


class Microcontroller(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        folder = pathlib.Path(cls.folder.name)
        cls.expected = [bytes(samples) for _, _, samples in CODES.decode("decode-host", False, FILES, folder)]
        cls.programs = {}
        for board, (_, flags) in BOARDS.items():
            cls.programs[board] = folder / f"{board}.elf"
            build(flags, cls.programs[board])

    def check_run(self, board, path, expected, rows):
        run = Run(board, self.programs[board], path, rows)
        with self.subTest(board=board, file=path.name, rows=rows):
            self.assertTrue(run.succeeded, run.printed)
            self.assertEqual(len(run.samples), len(expected))
            self.assertLessEqual(max(abs(a - b) for a, b in zip(run.samples, expected)), 1)  # FORMAT.md, "Precision"
            self.assertLessEqual(run.memory(), MAX_MEMORY_WITH_WHOLE if rows == WHOLE else MAX_MEMORY)
            self.assertLessEqual(run.numbers["stack"], MAX_STACK)
            self.assertLessEqual(run.seconds(), MAX_SECONDS)
        return run

    def row(self, board, path, run):
        n = run.numbers
        return (f"| {BOARDS[board][0]} | {n['file']} | {n['splats']} | {code_size(self.programs[board])} | {run.memory()} "
                f"| {n['instructions'] / 1e6:.1f} million | {n['reading'] / 1e6:.1f} million | {run.seconds():.3f} |\n")

    def test_strips(self):
        table = HEADING + "".join(
            self.row(board, path, self.check_run(board, path, expected, STRIP))
            for board in BOARDS for path, expected in zip(FILES, self.expected, strict=True))
        print("# " + table.rstrip("\n").replace("\n", "\n# "))
        if WRITE:
            readme = HERE / "README.md"
            readme.write_text(TABLE.sub(lambda _: table, readme.read_text()))

    def test_single_rows_and_the_whole_picture(self):
        for board in BOARDS:
            for rows in (1, WHOLE):
                self.check_run(board, FILES[-1], self.expected[-1], rows)

    def test_code(self):
        for board, program in self.programs.items():
            with self.subTest(board=board):
                self.assertLessEqual(code_size(program), MAX_CODE)
                names = [line.split()[0] for line in symbols(program) if line]
                self.assertEqual([name for name in names if UNWANTED.fullmatch(name)], [])


if __name__ == "__main__":
    CODES = Codes(sys.argv.pop(1))
    WRITE = "--write" in sys.argv
    if WRITE:
        sys.argv.remove("--write")
    missing = [name for name in (COMPILER, EMULATOR) if not shutil.which(name)]
    specs = not missing and subprocess.run([COMPILER, "-print-file-name=nano.specs"], capture_output=True, text=True).stdout
    if missing or "/" not in specs:
        print("1..0 # SKIP", *(missing or ["newlib"]), "not found")
        sys.exit(0)
    main()
