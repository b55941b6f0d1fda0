#!/bin/sh
# Builds Debian's source package and its binary packages: deb.sh FOLDER
#
# The folder debian/ is added to what tarball.sh writes, which is the upstream tarball.  Writes *.dsc, *.deb and their like, and
# FOLDER/build.
set -eu
. "$(dirname "$0")/common.sh"
folder=$1
install_packages $deb_packages

rm -rf "$folder/build"
mkdir "$folder/build"
sh "$here/tarball.sh" "$folder/build"
cd "$folder/build"
mv "gscl-$version.tar.xz" "gscl_$version.orig.tar.xz"
tar -xf "gscl_$version.orig.tar.xz"
cp -R "$here/debian" "gscl-$version/debian"
cd "gscl-$version"
dpkg-buildpackage -us -uc >"$folder/deb.log" 2>&1 || { tail -n 40 "$folder/deb.log" >&2; exit 1; }
cd ..
rm -f "$folder"/*gscl*_*.deb "$folder"/gscl_*
for file in *.*; do
    [ ! -f "$file" ] || mv "$file" "$folder"
done
ls "$folder"/*.dsc "$folder"/*.deb
