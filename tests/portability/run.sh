#!/bin/sh
# Tests the library without OpenCL on other machines: run.sh [--quick] [MACHINE...]
#
# MACHINE is the name of a file of meson beside this script, as s390x of s390x.ini.  Without one, all are tested, or with --quick
# those of quick_machines in tests/setup.sh.  Each is built by a compiler of Debian in build-portability/MACHINE, two at a time,
# and its programs run in qemu-user or wine.  --quick runs the conformance set, the kept inputs of the fuzz targets, and a program
# beside the shared library.  Without it all tests run that need no OpenCL, in up to half an hour for a machine.
#
# Prints a row for each machine, and ends with status 1 where one fails; build-portability/MACHINE.log has what was printed.
set -u
here=$(cd "$(dirname "$0")" && pwd)
cd "$here/../.."
. tests/setup.sh
quick=
[ "${1:-}" != --quick ] || { quick=--quick; shift; }
if [ $# = 0 ]; then
    machines=$(ls "$here"/*.ini | sed 's|.*/||; s|\.ini$||')
    [ -z "$quick" ] || machines=$quick_machines
    set -- $machines
fi
packages=
for machine in "$@"; do
    [ -f "$here/$machine.ini" ] || { echo "run.sh: no machine of this name: $machine" >&2; exit 2; }
    packages="$packages $(machine_packages "$machine")"
done
install_packages $build_packages $source_packages $packages || exit 1
work=$PWD/build-portability
mkdir -p "$work"
[ -n "$quick" ] || sh "$here/fetch_sources.sh" "$work/cmocka_sources" cmocka >"$work/cmocka.log" 2>&1 || {
    cat "$work/cmocka.log"
    exit 1
}

# Wine keeps its state in a folder, here one of this run, and a server, which ends soon after the last program.
WINEPREFIX=$(mktemp -d)
export WINEPREFIX
trap '[ ! -d "$WINEPREFIX/drive_c" ] || PATH=$PATH:/usr/lib/wine wineserver64 -w; rm -rf "$WINEPREFIX"' EXIT

printf '%-14s %-8s %-18s %s\n' machine builds 'conformance set' tests
printf '%s\n' "$@" | xargs -n 1 -P 2 sh "$here/machine.sh" $quick
