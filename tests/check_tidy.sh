#!/bin/sh
# host/ and format/ pass the checks of .clang-tidy: check_tidy.sh BUILD
# The build folder has meson's compile_commands.json.  Versions of clang-tidy differ: only 14 decides.
set -eu
build=$(cd "$1" && pwd)
cd "$(dirname "$0")/.."
tidy=$(command -v clang-tidy-14 || command -v clang-tidy)
case $("$tidy" --version) in
*"version 14."*) ;;
*) echo "skipped: not clang-tidy 14"; exit 0 ;;
esac
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT INT TERM
python3 tests/compile_commands.py "$build" >"$work/compile_commands.json"
# Those for Windows need its headers.
find host format -name '*.c' ! -name '*windows*' | sort | xargs -P "$(nproc)" -n 8 "$tidy" --quiet -p "$work" 2>/dev/null
