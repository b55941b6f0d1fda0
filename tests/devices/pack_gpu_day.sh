#!/bin/sh
# Puts what gpu_day.sh needs on a machine with a GPU and no packages into a folder:
#     sh tests/devices/pack_gpu_day.sh BUILD PICTURES FOLDER [NAME=OTHER_BUILD...]
#
# BUILD: a build of this machine with -Dtests=enabled.  The other machine needs a glibc as new as this one's, and, for the device
# "host", a processor of -Dnative_processors.
# PICTURES: a folder of PNG photographs.  LARGE_TILES (8) by as many of them, 768x512 each, make the large picture.
# NAME=OTHER_BUILD: a build with other tunables, whose library is timed beside that of BUILD.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
. "$here/../setup.sh"
build=$(cd "$1" && pwd)
pictures=$(cd "$2" && pwd)
mkdir -p "$3"
folder=$(cd "$3" && pwd)
shift 3
large_tiles=${LARGE_TILES:-8}

# Those of tests/unit and tests/stability that run kernels and read no file of the sources.
unit_tests="codebook fit_control fit_state gradients level_residual links placement quantise render scalar_rdo visual_loss"
stability_tests="adam encodes far_needles flat_ssim quantiser random"

# add_file FILE FOLDER [NAME]: without symbols for debugging.
add_file() {
    mkdir -p "$folder/$2"
    cp -L "$1" "$folder/$2/${3:-}"
    strip -g "$folder/$2/${3:-$(basename "$1")}" 2>/dev/null || true
}

# add_program FILE FOLDER: with the libraries that it is linked with, but for those of glibc and of gscl.
add_program() {
    add_file "$1" "$2"
    ldd "$1" | awk '$2 == "=>" { print $3 }' | while read -r library; do
        case $library in
        */libc.so* | */libm.so* | */libgscl* | */libpthread* | */libdl*) ;;
        *) add_file "$library" lib ;;
        esac
    done
}

add_programs() {
    add_program "$build/gscl" bin
    add_program "$build/tests/devices/opencl_probe" bin
    add_file "$build/libgscl.so.1" library libgscl.so.1
    for test in $unit_tests; do add_program "$build/tests/test_$test" tests; done
    for test in $stability_tests; do add_program "$build/tests/stability/stability_$test" tests; done
    cp "$here/gpu_day.sh" "$here/gpu_day_steps.sh" "$folder/"
}

# The programs of an ordinary encode in the GPU mapping, for opencl_probe.
add_kernels() {
    mkdir -p "$folder/kernels"
    python3 -B - "$here/../targets" "$build/tests/targets/list_programs" "$folder/kernels" <<'END'
import pathlib, sys
sys.path.insert(0, sys.argv[1])
import programs
for program in programs.read(sys.argv[2]):
    if (program.mapping, program.set) == ("gpu", "encode"):
        path = pathlib.Path(sys.argv[3], program.kind + ("-waves" if "waves" in program.use else ""))
        programs.write_source(f"{path}.cl", program.files)
        pathlib.Path(f"{path}.options").write_text(" ".join(program.options), encoding="ascii")
END
}

add_pictures() {
    mkdir -p "$folder/pictures" "$folder/conformance"
    cp "$pictures"/*.png "$folder/pictures/"
    for file in "$here"/../conformance/files/*.gscl; do
        # Many are there to be refused.
        if "$build/gscl" decode "$file" -o "$folder/decoded.png" --device host 2>/dev/null; then
            cp "$file" "$folder/conformance/"
        fi
    done
    rm "$folder/decoded.png"
}

# A JPEG, which is small enough to be carried.
add_large_picture() {
    install_packages imagemagick
    tiles=$((large_tiles * large_tiles))
    set -- "$pictures"/*.png
    while [ $# -lt $tiles ]; do set -- "$@" "$@"; done
    shift $(($# - tiles))
    montage "$@" -resize '768x512^' -gravity center -extent 768x512 -tile "${large_tiles}x" -geometry +0+0 -quality 90 "$folder/large.jpg"
}

add_programs
add_kernels
add_pictures
add_large_picture
for variant in "$@"; do
    add_file "${variant#*=}/libgscl.so.1" "variants/${variant%%=*}" libgscl.so.1
done
du -sh "$folder"
