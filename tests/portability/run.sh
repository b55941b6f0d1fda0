#!/bin/sh
# Tests the library, its encoder on the device "host", and the tool on other machines: run.sh [--quick | --whole] [MACHINE...]
#
# MACHINE is the name of a file of meson beside this script, as s390x of s390x.ini.  Without one, all are tested, or with --quick
# those of quick_machines in tests/setup.sh.  Each is built by a compiler of Debian in build-portability/MACHINE, two at a time,
# and its programs run in qemu-user, in wine, or as they are.  --quick builds the library, and runs the conformance set, kept inputs
# of the fuzz targets and three encodes of golden.txt.  Without it five of these run, the tests that need no OpenCL, and the tool,
# which encodes and decodes files (tool_files.sh): a few minutes of processor time for a machine.  --whole runs the tests of
# long_tests in machine.sh on the slow machines, too, which takes hours.
#
# Prints a row for each machine, and ends with status 1 where one fails; build-portability/MACHINE.log has what was printed.
set -u
here=$(cd "$(dirname "$0")" && pwd)
cd "$here/../.."
. tests/setup.sh
how=
case ${1:-} in
--quick | --whole)
    how=$1
    shift
    ;;
esac
if [ $# = 0 ]; then
    machines=$(ls "$here"/*.ini | sed 's|.*/||; s|\.ini$||')
    [ "$how" != --quick ] || machines=$quick_machines
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
if [ "$how" != --quick ]; then
    sh "$here/fetch_sources.sh" "$work/cmocka_sources" cmocka >"$work/cmocka.log" 2>&1 || { cat "$work/cmocka.log"; exit 1; }
    cp "$here/cmocka/meson.build" "$work/cmocka_sources/cmocka/"
fi

# Wine keeps its state in a folder, here one of this run, and a server, which ends soon after the last program.
WINEPREFIX=$(mktemp -d)
export WINEPREFIX
trap '[ ! -d "$WINEPREFIX/drive_c" ] || PATH=$PATH:/usr/lib/wine wineserver64 -w; rm -rf "$WINEPREFIX"' EXIT

printf '| %-10s | %-6s | %-15s | %-18s | %-9s | %-20s |\n' machine builds 'conformance set' 'encodes' "tool" 'tests'
echo '|---|---|---|---|---|---|'
printf '%s\n' "$@" | xargs -n 1 -P 2 sh "$here/machine.sh" $how
