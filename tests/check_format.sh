#!/bin/sh
# Sources look as .clang-format says.  Versions of clang-format differ in small things: only 14 decides.
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
