#!/usr/bin/env python3
"""A page of crops that show artefacts, before and after a change: the original, and each of several builds of gscl.

    sh tests/bench/bench.sh artefacts FOLDER --out DIR --gscl BEFORE --and build/gscl [--only NAMES]

FOLDER holds pictures of the Kodak set; those that it lacks are left out.  Writes DIR/index.html, which holds all that it shows,
and one PNG file for each row of crops.  The crops have their real size.
"""
import collections
import html
import pathlib
import tempfile
import types

import codec
import crops

# A place where files of this size and with these options showed an artefact; `at`: the left and upper pixel of the crop.
Artefact = collections.namedtuple("Artefact", "name image budget options at")
ARTEFACTS = [
    Artefact("false gratings from large textured splats", "kodim05", 300, "", (320, 128)),
    Artefact("false gratings from large textured splats", "kodim13", 2064, "", (0, 256)),
    Artefact("needles before mountains and sky", "kodim13", 2064, "", (512, 0)),
    Artefact("needles in water", "kodim13", 3244, "--tune visual", (256, 256)),
    Artefact("blotches in the sky", "kodim19", 3244, "", (0, 0)),
    Artefact("shapes that are not there", "kodim23", 150, "", (128, 128)),
]
SIZE = (256, 256)  # of a crop, pixels


def rows_of(artefact, arguments, work):
    """The part of the page for one artefact."""
    image = pathlib.Path(arguments.folder) / f"{artefact.image}.png"
    versions = [crops.Version("original", None, {}, crops.load(image))]
    for gscl in arguments.builds:
        build = types.SimpleNamespace(gscl=gscl)
        version = crops.code_gscl(build, artefact.options, image, artefact.budget, work)
        versions.append(version._replace(name=gscl))
    options = f" {artefact.options}" if artefact.options else ""
    heading = html.escape(f"{artefact.name}: {artefact.image}, {artefact.budget} bytes{options}")
    name = artefact.name.replace(" ", "-")
    crops.write_row(versions, artefact.at, SIZE, arguments.out / f"{name}-{artefact.image}-{artefact.budget}.png")
    cells = "\n".join(crops.cell_of(version, artefact.at, SIZE) for version in versions)
    return f"<h2>{heading}</h2>\n<table><tr>\n{cells}\n</tr></table>"


def parse():
    parser = codec.parser(__doc__)
    parser.add_argument("--out", required=True, type=pathlib.Path, help="folder for the page; it is made if it is missing")
    parser.add_argument("--and", dest="others", action="append", default=[], help="a further build of gscl, to the right of --gscl")
    return parser.parse_args()


def main():
    arguments = parse()
    arguments.builds = [arguments.gscl, *arguments.others]
    names = {image.stem for image in codec.images_of(arguments.folder, arguments.only)}
    shown = [artefact for artefact in ARTEFACTS if artefact.image in names]
    if not shown:
        raise SystemExit(f"{arguments.folder}: holds none of {', '.join(sorted({a.image for a in ARTEFACTS}))}")
    arguments.out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        rows = [rows_of(artefact, arguments, pathlib.Path(folder)) for artefact in shown]
    crops.write_page("Artefacts before and after", rows, arguments.out)


if __name__ == "__main__":
    main()
