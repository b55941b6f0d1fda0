#!/bin/sh
# Tests the static program that host/packaging/build.sh has written in a folder: test_static.sh FOLDER
#
# It has at most 10 MB and needs no other file: with nothing but itself and an image in a root folder, it encodes and decodes PNG
# and JPEG.  Needs root.
set -eu
program=$(cd "$1" && pwd)/gscl
image=$(cd "$(dirname "$0")/.." && pwd)/sample/readme.png
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT INT TERM

fail() {
    echo "test_static: $*" >&2
    exit 1
}

size=$(stat -c %s "$program")
[ "$size" -le 10000000 ] || fail "has $size bytes"
if readelf -l "$program" | grep -E 'INTERP|DYNAMIC'; then
    fail "asks for a loader"
fi
cp "$program" "$image" "$work"
alone() {
    env -i /usr/sbin/chroot "$work" /gscl "$@"
}
began=$(date +%s)
alone encode readme.png a.gscl --bytes 2000 --effort 2
alone decode a.gscl a.png
echo "from nothing to a decoded picture: $(($(date +%s) - began)) s, $size bytes"
alone decode a.gscl a.jpg
alone encode a.jpg b.gscl --effort 0
alone compare readme.png a.png
[ "$(stat -c %s "$work/a.gscl")" -le 2000 ] || fail "is above its budget"
alone decode a.gscl a.ppm
if alone encode a.ppm c.gscl 2>"$work/log"; then
    fail "reads PNM, which its message says it does not"
fi
grep -q 'built without; it reads PNG and JPEG' "$work/log" || fail "does not say what it reads: $(cat "$work/log")"
