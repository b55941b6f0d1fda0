#!/bin/sh
# Builds the program for x86-64 Linux as one file that needs nothing else: static.sh FOLDER; FOLDER/gscl.
#
# It is linked with musl, which has no loader in a static program: neither OpenCL nor OpenImageIO can be opened.  Encoding and
# decoding take the processor, and images are PNG and JPEG.  Writes FOLDER/build, too.
set -eu
. "$(dirname "$0")/common.sh"
folder=$1
install_packages $static_packages $(machine_packages musl)

build() {
    sh "$root/tests/portability/image_libraries.sh" musl "$folder/libraries"
    again=
    [ ! -f "$folder/build/build.ninja" ] || again=--reconfigure
    PKG_CONFIG_LIBDIR="$folder/libraries/lib/pkgconfig" meson setup $again "$folder/build" "$root" \
        --cross-file "$root/tests/portability/musl.ini" -Ddefault_library=static -Dprefer_static=true -Db_pie=false \
        -Dc_link_args=-static -Dopencl=disabled -Dnative=enabled -Dtool=enabled -Dimage_module=disabled -Dplots=disabled \
        -Dtests=disabled -Dweb=disabled -Dopenimageio=disabled -Ddesktop=disabled
    ninja -C "$folder/build" gscl
    strip -o "$folder/gscl" "$folder/build/gscl"
}
build >"$folder/static.log" 2>&1 || { tail -n 20 "$folder/static.log" >&2; exit 1; }
echo "$folder/gscl"
