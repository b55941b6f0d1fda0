"""For test_recipes.sh: builds a recipe of conda, and carries out its tests, with the machine's own tools and libraries:
build_conda.py RECIPE FOLDER

The packages that the recipe requires come from a channel that this makes in FOLDER.  They are empty, but that the compiler tells Meson
where to install, as that of conda-forge does.
"""

import hashlib
import json
import pathlib
import re
import sys

import rattler_build

PLATFORM = "linux-64"
VARIANT = "c_compiler: [gcc]\ncxx_compiler: [gxx]\nc_stdlib: [sysroot]\nc_stdlib_version: ['2.28']\n"
IMPLIED = {"bash": "1.0", "gcc_linux-64": "1.0", "gxx_linux-64": "1.0", "sysroot_linux-64": "2.28"}  # names and versions
ACTIVATION = 'export MESON_ARGS="--buildtype release --prefix=$PREFIX -Dlibdir=lib"\n'


def requirements(text):
    """The names of the packages that are listed in the part `requirements` of a recipe."""
    part = text.split("\nrequirements:\n", 1)[1].split("\n\n", 1)[0]
    return re.findall(r"^ +(?:- |then: )([a-z0-9-]+)(?: #.*)?$", part, flags=re.M)


def make_package(name, version, channel, activation):
    """Writes a package into the channel.  Returns its row in the list of packages."""
    files = {"files_dir": activation} if name.startswith("gcc") else {}
    made = rattler_build.assemble_package(name, version, "noarch", "0", channel / "noarch", noarch="generic", **files)
    data = pathlib.Path(made.path).read_bytes()
    row = {"name": name, "version": version, "build": "0", "build_number": 0, "depends": [], "subdir": "noarch", "noarch": "generic"}
    return pathlib.Path(made.path).name, {**row, "size": len(data), "sha256": hashlib.sha256(data).hexdigest()}


def make_channel(names, folder):
    channel, activation = folder / "channel", folder / "activation"
    (activation / "etc/conda/activate.d").mkdir(parents=True)
    (activation / "etc/conda/activate.d/meson.sh").write_text(ACTIVATION, encoding="ascii")
    for name in "noarch", PLATFORM:
        (channel / name).mkdir(parents=True)
    packages = dict(make_package(name, IMPLIED.get(name, "1.0"), channel, activation) for name in sorted({*names, *IMPLIED}))
    for name, rows in ("noarch", packages), (PLATFORM, {}):
        text = json.dumps({"info": {"subdir": name}, "packages": {}, "packages.conda": rows, "repodata_version": 1})
        (channel / name / "repodata.json").write_text(text, encoding="ascii")
    return [channel.as_uri()]


def main(recipe, folder):
    folder = pathlib.Path(folder).resolve()
    channels = make_channel(requirements(pathlib.Path(recipe).read_text(encoding="utf-8")), folder)
    platform = rattler_build.PlatformConfig(target_platform=PLATFORM)
    config = rattler_build.RenderConfig(platform=platform)
    (variant,) = rattler_build.Stage0Recipe.from_file(recipe).render(rattler_build.VariantConfig.from_yaml(VARIANT), config)
    settings = rattler_build.ToolConfiguration(use_zstd=False, use_bz2=False, use_sharded=False)
    result = variant.run_build(settings, folder / "output", channels=channels)
    results = rattler_build.Package.from_file(result.packages[0]).run_tests(channel=channels)
    for test in results:
        print("\n".join(test.output))
    if not results or not all(test.success for test in results):
        sys.exit("a test of the package failed")


if __name__ == "__main__":
    main(*sys.argv[1:])
