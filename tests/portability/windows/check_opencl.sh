#!/bin/sh
# Tests OpenCL on Windows with Wine, whose opencl.dll calls the OpenCL of this machine: check_opencl.sh [PROGRAM]
#
# Builds the library and the tool with OpenCL in build-portability/mingw-opencl, in a few minutes; run.sh has built the tool's libraries
# for mingw.  The tool lists the first device, decodes on it, encodes, and decodes the conformance set.  PROGRAM is the tool of this
# machine, with OpenCL: its file has to be the same.
set -eu
here=$(cd "$(dirname "$0")/.." && pwd)
work=$(cd "$here/../../build-portability" && pwd)
folder=$work/mingw-opencl
export PATH="$PATH:$here" PKG_CONFIG_LIBDIR="$work/prefix-mingw/lib/pkgconfig"
made=$(mktemp -d)
WINEPREFIX=$made/wine
export WINEPREFIX
trap 'PATH=$PATH:/usr/lib/wine wineserver64 -w; rm -rf "$made"' EXIT

# The headers of OpenCL, without those of this machine's C library beside them.
headers=$work/prefix-mingw/opencl
mkdir -p "$headers"
ln -sfn /usr/include/CL "$headers/CL"
again=
[ ! -f "$folder/build.ninja" ] || again=--reconfigure
meson setup $again "$folder" "$here/../.." --cross-file "$here/mingw.ini" -Dc_args=-I"$headers" -Dnative_processors=x86_64_v3 \
    -Dopencl=enabled -Dnative=enabled -Dtool=enabled -Dtests=enabled -Dimage_module=disabled -Dplots=disabled -Dweb=disabled \
    -Dopenimageio=disabled -Ddesktop=disabled
ninja -C "$folder" gscl.exe tests/codes.exe

tool="sh $here/wine.sh $folder/gscl.exe"
$tool devices
$tool decode --device 0.0 "$here/../conformance/files/example.gscl" --size 64x48 -o "$made/image.png"
$tool encode --device 0.0 --effort 1 "$made/image.png" -o "$made/windows.gscl"
if [ $# -gt 0 ]; then
    "$1" encode --device 0.0 --effort 1 "$made/image.png" -o "$made/here.gscl"
    cmp "$made/windows.gscl" "$made/here.gscl"
fi
MESON_EXE_WRAPPER="sh $here/wine.sh" python3 "$here/../conformance/test_conformance.py" "$folder/tests/codes.exe" Library
