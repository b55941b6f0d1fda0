#!/bin/sh
# Tests the source tarball that host/packaging/build.sh has written in a folder: test_tarball.sh [--quick] FOLDER
#
# It has the files of the last commit and no others.  Without --quick its library is built, as a machine without a network would,
# and a program is compiled with the installed library, in about two minutes of processor time.
set -eu
quick=
[ "$1" != --quick ] || { quick=yes; shift; }
here=$(cd "$(dirname "$0")" && pwd)
tarball=$(echo "$1"/gscl-*.tar.xz)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT INT TERM
name=$(basename "$tarball" .tar.xz)

tar -tf "$tarball" | grep -v '/$' | sed "s|^$name/||" | sort >"$work/in_tarball"
git -C "$here/../.." ls-tree -r --name-only HEAD | sort >"$work/in_commit"
diff "$work/in_commit" "$work/in_tarball"
tar -xf "$tarball" -C "$work"
[ -z "$quick" ] || exit 0

. "$here/without_network.sh"
$without_network meson setup "$work/build" "$work/$name" -Dtool=disabled -Dtests=disabled -Dnative_processors=own >"$work/log" &&
    $without_network ninja -C "$work/build" >"$work/log" || {
    tail -n 20 "$work/log"
    exit 1
}
sh "$here/../install/test_install.sh" "$work/build"
