#!/bin/sh
# Writes the sources of the last commit: tarball.sh FOLDER; FOLDER/gscl-VERSION.tar.xz, equal for equal commits.
set -eu
. "$(dirname "$0")/common.sh"
folder=$1
install_packages $tarball_packages

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT INT TERM
log=$folder/tarball.log
{
    # The least that meson can configure: a library that only decodes.
    meson setup "$work/build" "$root" -Dopencl=disabled -Dnative=disabled -Dtool=disabled -Dtests=disabled &&
        meson dist -C "$work/build" --formats xztar --no-tests --allow-dirty
} >"$log" 2>&1 || { tail -n 20 "$log" >&2; exit 1; }
cp "$work/build/meson-dist/gscl-$version.tar.xz" "$folder"
echo "$folder/gscl-$version.tar.xz"
