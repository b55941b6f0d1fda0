"""Prints the table of README.md: sizes.py FOLDER, in which tests/packaging/run.sh --whole has built all packages."""

import io
import pathlib
import subprocess
import sys
import tarfile
import zipfile


def unpacked(path):
    """The bytes of all files that a package installs."""
    if path.suffix == ".whl":
        with zipfile.ZipFile(path) as wheel:
            return sum(entry.file_size for entry in wheel.infolist())
    if path.name == "gscl":
        return path.stat().st_size
    data = path.read_bytes()
    if path.suffix == ".deb":
        data = subprocess.run(["dpkg-deb", "--fsys-tarfile", path], check=True, stdout=subprocess.PIPE).stdout
    with tarfile.open(fileobj=io.BytesIO(data)) as archive:
        return sum(member.size for member in archive)


def main(folder):
    kinds = ["tarball/*.tar.xz", "sdist/*.tar.gz", "wheel/*.whl", "npm/*.tgz", "static/gscl", "deb/*.deb"]
    print("| package | kB | unpacked, kB |\n|---|---|---|")
    for path in (path for kind in kinds for path in sorted(pathlib.Path(folder).glob(kind)) if "dbgsym" not in path.name):
        name = "gscl (static program)" if path.name == "gscl" else path.name
        print(f"| {name} | {path.stat().st_size / 1000:.0f} | {unpacked(path) / 1000:.0f} |")


main(*sys.argv[1:])
