#!/bin/sh
# Tests the source distribution of the Python package that host/packaging/build.sh has written in a folder:
# test_sdist.sh [--quick] FOLDER
#
# It has the library, with its licence, and nothing that was built.  Without --quick it is built without a network by what it
# requires, which FOLDER/venv has, and used, in about two minutes of processor time.
set -eu
quick=
[ "$1" != --quick ] || { quick=yes; shift; }
here=$(cd "$(dirname "$0")" && pwd)
folder=$(cd "$1" && pwd)
sdist=$(echo "$folder"/gscl-*.tar.gz)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT INT TERM
name=$(basename "$sdist" .tar.gz)

tar -tf "$sdist" >"$work/list"
for file in PKG-INFO pyproject.toml meson.build gscl/__init__.py subprojects/gscl/LICENSE subprojects/gscl/meson.build \
    subprojects/gscl/host/include/gscl/gscl.h subprojects/gscl/cl/fit.cl subprojects/gscl/format/format.c; do
    grep -qx "$name/$file" "$work/list" || { echo "$sdist lacks $file"; exit 1; }
done
if grep -E '/build/|/tests/|\.(o|so|a|pyc|gscl)$' "$work/list"; then
    exit 1
fi
[ -z "$quick" ] || exit 0

. "$here/without_network.sh"
"$folder/venv/bin/pip" --disable-pip-version-check --quiet install numpy pillow
PATH="$folder/venv/bin:$PATH" $without_network "$folder/venv/bin/pip" --disable-pip-version-check --quiet install --no-index \
    --no-deps --no-build-isolation --force-reinstall -Csetup-args=-Dgscl:native_processors=own "$sdist"
cd "$work"
"$folder/venv/bin/python" "$here/encode_decode.py"
