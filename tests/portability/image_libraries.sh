#!/bin/sh
# Builds the libraries that the tool needs, for a machine for which this one has no packages of them, as static libraries:
# image_libraries.sh MACHINE PREFIX
#
# MACHINE is the name of a file of meson beside this script.  They are zlib, libpng, libjpeg-turbo and LittleCMS, with the patches
# of Debian and without code for single processors.  meson finds them in PREFIX with PKG_CONFIG_LIBDIR=PREFIX/lib/pkgconfig.
# Needs dpkg-dev, meson and the machine's compiler.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
machine=$1
mkdir -p "$2" "$here/../../build-portability"
prefix=$(cd "$2" && pwd)
work=$(cd "$here/../../build-portability" && pwd)
sources=$work/image_libraries
[ ! -f "$prefix/lib/pkgconfig/lcms2.pc" ] || exit 0
# Machines are built at the same time.
exec 9>"$sources.lock"
flock 9
sh "$here/fetch_sources.sh" "$sources" zlib libpng1.6 libjpeg-turbo lcms2
cp "$here/image_libraries/meson.build" "$sources/"
flock -u 9
again=
[ ! -f "$work/image_libraries-$machine/build.ninja" ] || again=--wipe
meson setup $again "$work/image_libraries-$machine" "$sources" --cross-file "$here/$machine.ini" --prefix "$prefix"
meson install -C "$work/image_libraries-$machine" --quiet
