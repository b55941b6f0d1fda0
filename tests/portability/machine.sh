#!/bin/sh
# Builds and tests for one machine, whose packages are installed, and prints its row: machine.sh [--quick] MACHINE
#
# run.sh calls it.  The tests that were run are listed in build-portability/MACHINE/meson-logs/testlog.json.
set -u
here=$(cd "$(dirname "$0")" && pwd)
quick=
[ "$1" != --quick ] || { quick=yes; shift; }
machine=$1
work=$(cd "$here/../../build-portability" && pwd)
folder=$work/$machine
prefix=$work/cmocka-$machine
log=$work/$machine.log
results=$folder/meson-logs/testlog.json
rm -f "$results"
export PKG_CONFIG_LIBDIR="$prefix/lib/pkgconfig" # not that of this machine
export PATH="$PATH:$here" STABILITY_SMALL=1

# set_up FOLDER SOURCES [MESON OPTIONS]
set_up() {
    again=
    [ ! -f "$1/build.ninja" ] || again=--reconfigure
    meson setup $again "$@" --cross-file "$here/$machine.ini" && ninja -C "$1"
}

build() {
    if [ -z "$quick" ]; then
        set_up "$work/build-cmocka-$machine" "$work/cmocka_sources/cmocka" --prefix "$prefix" &&
            meson install -C "$work/build-cmocka-$machine" --no-rebuild --quiet || return 1
        set -- -Dtests=enabled
    fi
    set_up "$folder" "$here/../.." -Dopencl=disabled -Dnative=disabled -Dtool=disabled -Dweb=disabled -Dopenimageio=disabled \
        -Ddesktop=disabled "$@" || return 1
    for library in "$folder"/*.dll; do
        [ ! -f "$library" ] || sh "$here/../install/check_exports.sh" "$library" || return 1
    done
}

# An emulator takes ten times as long; a limit only ends a test that hangs.
if build >"$log" 2>&1; then
    set --
    [ -z "$quick" ] || set -- conformance_set without_opencl "fuzz reader" "fuzz writer"
    meson test -C "$folder" --no-rebuild --print-errorlogs --timeout-multiplier 2 "$@" >>"$log" 2>&1
    failed=$?
    right=$(sed -n 's/^# decode-host: \(.*\) files right.*/\1/p' "$folder/meson-logs/testlog.txt")
    [ -n "$right" ] || failed=1
    counts=$(python3 "$here/../count_results.py" "$results")
    printf '%-14s %-8s %-18s %s\n' "$machine" yes "${right:-none}" "${counts% *} passed, ${counts#* } failed"
else
    failed=1
    printf '%-14s %-8s %-18s %s\n' "$machine" no - -
fi
[ "$failed" = 0 ] || {
    echo "of $log:"
    grep -E '^(FAILED|not ok)|error' "$log" | head -n 20
    echo "..."
    tail -n 5 "$log"
} | sed 's/^/    /'
exit "$failed"
