#!/bin/sh
# Checks that the sources are formatted by .clang-format.  Only version 14 decides, because versions differ slightly.
set -eu
cd "$(dirname "$0")/.."
formatter=$(command -v clang-format-14 || command -v clang-format)
case $("$formatter" --version) in
*"version 14."*) ;;
*) echo "skipped: not clang-format 14"; exit 0 ;;
esac
status=0
for file in $(find cl format host tests -name '*.[ch]' -o -name '*.cl' -o -name '*.cpp' | sort); do
    if ! "$formatter" "$file" | cmp -s - "$file"; then
        echo "$file: run $(basename "$formatter") -i on it"
        status=1
    fi
done
exit $status
