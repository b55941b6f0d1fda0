#!/usr/bin/env python3
"""Collects the pictures on which the probability tables of the format are trained, as PNG files into a folder:

    tests/bench/corpus.py OUT [--packages FOLDER] [--only PACKAGE,...]

The pictures lie in packages of Debian, Ubuntu and PyPI that corpus.txt beside this script names.  The packages are
downloaded by apt-get and pip and unpacked, not installed; the configuration and the package lists of the system stay
as they are.  Each picture is converted to sRGB with 8 bits per sample and shrunk by a Lanczos filter to an area that
its name selects: 0.393 megapixels for two of three pictures, otherwise 0.1, 0.2 or 0.8.  Pictures with transparent
parts and near duplicates are left out.  Three of four go into OUT/photo/train and OUT/drawing/train, the others into
OUT/photo/held and OUT/drawing/held; the name decides this too, so that every run gives the same folders.
"""
import argparse
import fnmatch
import hashlib
import io
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unicodedata
import zipfile

import numpy
from PIL import Image, ImageCms, ImageOps

LIST = pathlib.Path(__file__).with_name("corpus.txt")
KINDS = ("photo", "drawing", "skip")
DEBIAN, UBUNTU = ("bookworm", "bullseye", "trixie"), ("noble",)
SUFFIXES = (".jpg", ".jpeg", ".png", ".webp")
AREA, OTHER_AREAS = 768 * 512, (100_000, 200_000, 800_000)  # pixels
SMALLEST_SIDE = 160  # pixels, of the source
DUPLICATE_DISTANCE = 10  # root mean square of the differences of thumbnails with 16 x 16 pixels, of 255
HELD = 4  # one of this many pictures is held out of the training

Image.MAX_IMAGE_PIXELS = 1 << 28


class Entry:
    """A line of the list: the kind of the pictures of a package whose paths match a pattern."""

    def __init__(self, number, line):
        words = line.split(None, 2)
        if len(words) != 3 or words[0] not in KINDS or words[1].count("/") != 1:
            raise SystemExit(f"{LIST.name}:{number}: needs 'photo|drawing|skip PACKAGE/RELEASE PATTERN', holds '{line}'")
        self.kind, self.package, self.pattern = words
        fixed = re.split(r"[*?\[]", self.pattern)[0]
        self.folder = fixed[:fixed.rfind("/") + 1]

    def name(self, path):
        """The name of the picture: the package and the path below the folder of the pattern, in ASCII."""
        text = f"{self.package.split('/')[0]}.{path[len(self.folder):].rsplit('.', 1)[0]}"
        text = unicodedata.normalize("NFKD", text).encode("ascii", "ignore").decode()
        return re.sub(r"[^A-Za-z0-9._+-]+", "_", text)


def read_list():
    lines = enumerate(LIST.read_text(encoding="utf-8").splitlines(), 1)
    return [Entry(number, line.strip()) for number, line in lines if line.strip() and not line.startswith("#")]


def run(*words, cwd=None, **environment):
    done = subprocess.run([str(word) for word in words], cwd=cwd, capture_output=True, text=True,
                          env={**os.environ, **environment})
    if done.returncode:
        raise SystemExit(f"{' '.join(map(str, words))}: {done.stderr.strip()}")


class Apt:
    """apt-get with sources and package lists of its own in a folder."""

    def __init__(self, folder):
        self.folder = folder.resolve()
        self.keyring = self.folder / "apt" / "keyring"
        self.ready = set()

    def _update(self, name, sources):
        """Prepares a distribution; the sources are lines of sources.list."""
        home = self.folder / "apt" / name
        for part in ("lists/partial", "cache/archives/partial"):
            (home / part).mkdir(parents=True, exist_ok=True)
        (home / "sources.list").write_text("".join(f"{line}\n" for line in sources), encoding="utf-8")
        (home / "apt.conf").write_text(f'Dir::Etc::sourcelist "{home}/sources.list";\nDir::Etc::sourceparts "-";\n'
                                       f'Dir::State::lists "{home}/lists";\nDir::Cache "{home}/cache";\n'
                                       'Acquire::Languages "none";\nAPT::Sandbox::User "root";\n', encoding="utf-8")
        run("apt-get", "-q", "update", APT_CONFIG=str(home / "apt.conf"))
        self.ready.add(name)

    def _prepare(self, name):
        if name in self.ready:
            return
        if name == "debian":
            self._update(name, [f"deb http://deb.debian.org/debian {release} main" for release in DEBIAN])
            return
        keyring = unpack(self.package("ubuntu-keyring", "trixie"), self.keyring) / "usr/share/keyrings/ubuntu-archive-keyring.gpg"
        self._update(name, [f"deb [signed-by={keyring}] http://archive.ubuntu.com/ubuntu {release} main universe"
                            for release in UBUNTU])

    def package(self, package, release):
        """The file of a package, downloaded if it is not there yet."""
        folder = self.folder / release
        found = sorted(folder.glob(f"{package}_*.deb"))
        if not found:
            name = "ubuntu" if release in UBUNTU else "debian"
            self._prepare(name)
            folder.mkdir(parents=True, exist_ok=True)
            run("apt-get", "-q", "download", f"{package}/{release}", cwd=folder,
                APT_CONFIG=str(self.folder / "apt" / name / "apt.conf"))
            found = sorted(folder.glob(f"{package}_*.deb"))
        return found[-1]


def wheel(package, folder):
    """The file of a package of PyPI, downloaded if it is not there yet."""
    stem = package.replace("-", "_")
    if not sorted(folder.glob(f"{stem}-*.whl")):
        run(sys.executable, "-m", "pip", "-q", "download", "--no-deps", "--only-binary", ":all:", "-d", folder, package)
    return sorted(folder.glob(f"{stem}-*.whl"))[-1]


def unpack(file, folder):
    if file.suffix == ".whl":
        with zipfile.ZipFile(file) as archive:
            archive.extractall(folder)
    else:
        run("dpkg-deb", "-x", file, folder)
    return folder


def matches(folder, entries):
    """Pairs of an entry and a path; the first entry that matches a path decides."""
    paths = sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*")
                   if path.suffix.lower() in SUFFIXES and path.is_file() and not path.is_symlink())
    for path in paths:
        entry = next((entry for entry in entries if fnmatch.fnmatchcase(path, entry.pattern)), None)
        if entry and entry.kind != "skip":
            yield entry, path


def digest(name, purpose):
    """A number that the name of a picture selects, the same in every run."""
    return int.from_bytes(hashlib.sha256(f"{purpose} {name}".encode()).digest()[:8], "big")


def area_of(name, pixels):
    """The area that the picture shrinks to, or 0 if it is too small for each."""
    number = digest(name, "area") % 9
    area = AREA if number < 6 else OTHER_AREAS[number - 6]
    return area if area <= pixels else max((other for other in (AREA, *OTHER_AREAS) if other <= pixels), default=0)


def to_srgb(image):
    """The picture upright, in sRGB and without alpha channel, or None if parts of it are transparent."""
    profile = image.info.get("icc_profile")
    image = ImageOps.exif_transpose(image)
    if image.has_transparency_data:
        image = image.convert("RGBA")
        if image.getchannel("A").getextrema()[0] < 255:
            return None
    if profile and image.mode in ("RGB", "RGBA", "CMYK", "L"):
        image = image.convert("RGB") if image.mode == "RGBA" else image
        try:
            image = ImageCms.profileToProfile(image, ImageCms.ImageCmsProfile(io.BytesIO(profile)),
                                              ImageCms.createProfile("sRGB"), outputMode="RGB")
        except ImageCms.PyCMSError:
            return None
    return image.convert("RGB")


def shrunk(path, name):
    """The picture of a file as the corpus holds it, or None if it is too small, transparent or not readable."""
    with Image.open(path) as image:
        area = area_of(name, image.width * image.height)
        if not area or min(image.size) < SMALLEST_SIDE or image.mode.startswith(("I", "F")):
            return None
        scale = (area / (image.width * image.height)) ** 0.5
        image.draft("RGB", tuple(round(2 * scale * side) for side in image.size))
        image = to_srgb(image)
    if not image:
        return None
    scale = (area / (image.width * image.height)) ** 0.5
    return image.resize([max(1, round(scale * side)) for side in image.size], Image.Resampling.LANCZOS)


class Seen:
    """The thumbnails of the pictures so far."""

    def __init__(self):
        self.thumbnails = []

    def add(self, image):
        """Adds a picture; returns false if one much like it is there already."""
        thumbnail = numpy.asarray(image.resize((16, 16), Image.Resampling.BOX), dtype=numpy.float32).ravel()
        if self.thumbnails and (numpy.stack(self.thumbnails) - thumbnail).std(axis=1).min() < DUPLICATE_DISTANCE:
            return False
        self.thumbnails.append(thumbnail)
        return True


def collect(out, folder, entries, seen):
    """Writes the pictures of one unpacked package; returns how many of each kind."""
    counts = dict.fromkeys(KINDS, 0)
    for entry, path in matches(folder, entries):
        name = entry.name(path)
        try:
            image = shrunk(folder / path, name)
        except (OSError, SyntaxError, ValueError) as error:
            print(f"{path}: {error}", file=sys.stderr)
            image = None
        if not image or not seen.add(image):
            counts["skip"] += 1
            continue
        part = "train" if digest(name, "part") % HELD else "held"
        if any(out.rglob(f"{name}.png")):
            raise SystemExit(f"{LIST.name}: two pictures have the name {name}, the second is {path}; put a * behind an earlier folder")
        image.save(out / entry.kind / part / f"{name}.png")
        counts[entry.kind] += 1
    return counts


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", metavar="OUT", type=pathlib.Path, help="folder for the pictures, which must not hold any yet")
    parser.add_argument("--packages", type=pathlib.Path, metavar="FOLDER",
                        help="folder that keeps the packages for the next run (default: a temporary one); about 1.5 GB")
    parser.add_argument("--only", default="", help="names of packages, separated by commas (default: all of the list)")
    arguments = parser.parse_args()
    entries = read_list()
    packages = list(dict.fromkeys(entry.package for entry in entries))
    if arguments.only:
        names = arguments.only.split(",")
        packages = [package for package in packages if package.split("/")[0] in names]
        if not packages:
            raise SystemExit(f"--only {arguments.only}: names no package of {LIST.name}")
    if any(arguments.out.rglob("*.png")):
        raise SystemExit(f"{arguments.out}: holds pictures already; name an empty folder")
    for kind in ("photo", "drawing"):
        for part in ("train", "held"):
            (arguments.out / kind / part).mkdir(parents=True, exist_ok=True)
    seen, totals = Seen(), dict.fromkeys(KINDS, 0)
    with tempfile.TemporaryDirectory() as work:
        store = arguments.packages or pathlib.Path(work, "packages")
        store.mkdir(parents=True, exist_ok=True)
        apt = Apt(store)
        for package in packages:
            name, release = package.split("/")
            file = wheel(name, store) if release == "pypi" else apt.package(name, release)
            with tempfile.TemporaryDirectory(dir=work) as folder:
                counts = collect(arguments.out, unpack(file, pathlib.Path(folder)),
                                 [entry for entry in entries if entry.package == package], seen)
            print(f"{package}: " + ", ".join(f"{counts[kind]} {kind}" for kind in KINDS), flush=True)
            totals = {kind: totals[kind] + counts[kind] for kind in KINDS}
    print("total: " + ", ".join(f"{totals[kind]} {kind}" for kind in KINDS))


if __name__ == "__main__":
    main()
