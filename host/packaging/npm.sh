#!/bin/sh
# Builds the package of npm: npm.sh FOLDER; FOLDER/gscl-VERSION.tgz, and FOLDER/build.
set -eu
. "$(dirname "$0")/common.sh"
folder=$1
install_packages $npm_packages
if ! command -v npm >/dev/null; then
    echo "npm.sh: needs Node 20 with npm" >&2
    exit 1
fi

build() {
    again=
    [ ! -f "$folder/build/build.ninja" ] || again=--reconfigure
    meson setup $again "$folder/build" "$root" -Dweb=enabled -Dweb_encoder=enabled -Dopencl=disabled -Dnative=disabled \
        -Dtool=disabled -Dtests=disabled -Dopenimageio=disabled -Ddesktop=disabled
    ninja -C "$folder/build" web-page
    npm pack "$folder/build/host/web" --pack-destination "$folder"
}
build >"$folder/npm.log" 2>&1 || { tail -n 20 "$folder/npm.log" >&2; exit 1; }
ls "$folder"/gscl-*.tgz
