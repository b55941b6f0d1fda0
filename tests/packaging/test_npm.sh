#!/bin/sh
# Tests the package of npm: test_npm.sh [--quick] PACKAGE WORK
#
# PACKAGE is a tarball of host/packaging/build.sh, or host/web of a build folder; WORK, a folder for publint, which has no complaint.
# Without --quick a tarball is installed in an empty folder, and Node encodes and decodes with it, in some seconds.
set -eu
quick=
[ "$1" != --quick ] || { quick=yes; shift; }
here=$(cd "$(dirname "$0")" && pwd)
package=$(realpath "$1")
mkdir -p "$2"
tools=$(cd "$2" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT INT TERM

[ -x "$tools/node_modules/.bin/publint" ] ||
    npm install --prefix "$tools" --no-audit --no-fund --ignore-scripts --loglevel=error publint@0.3
"$tools/node_modules/.bin/publint" run "$package" --strict
[ -z "$quick" ] || exit 0

began=$(date +%s)
cd "$work"
npm install --no-audit --no-fund --loglevel=error "$package"
cp "$here/encode_decode.mjs" .
node encode_decode.mjs
echo "from nothing to a decoded picture: $(($(date +%s) - began)) s"
