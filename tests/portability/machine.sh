#!/bin/sh
# Builds and tests for one machine, whose packages are installed, and prints its row: machine.sh [--quick | --whole] MACHINE
#
# run.sh calls it.  The tests that were run are listed in build-portability/MACHINE/meson-logs/testlog.json; encodes.txt beside it has
# the counts of encodes that passed and failed, and of the tool's files.
set -u
here=$(cd "$(dirname "$0")" && pwd)
how=usual
case $1 in
--quick | --whole)
    how=${1#--}
    shift
    ;;
esac
machine=$1
work=$(cd "$here/../../build-portability" && pwd)
folder=$work/$machine
prefix=$work/prefix-$machine
log=$work/$machine.log
results=$folder/meson-logs/testlog.json
rm -f "$results" "$folder/meson-logs/encodes.txt"
export PKG_CONFIG_LIBDIR="$prefix/lib/pkgconfig" # not that of this machine
export PATH="$PATH:$here" STABILITY_SMALL=1

# set_up FOLDER SOURCES [MESON OPTIONS]
set_up() {
    again=
    [ ! -f "$1/build.ninja" ] || again=--reconfigure
    meson setup $again "$@" --cross-file "$here/$machine.ini" && ninja -C "$1"
}

# Kernels are compiled for one processor of x86-64, whose others are tested on this machine, and for none where there are none.
build() {
    set -- -Dtool=disabled
    if [ "$how" != quick ]; then
        sh "$here/image_libraries.sh" "$machine" "$prefix" || return 1
        set_up "$work/build-cmocka-$machine" "$work/cmocka_sources/cmocka" --prefix "$prefix" &&
            meson install -C "$work/build-cmocka-$machine" --no-rebuild --quiet || return 1
        set -- -Dtool=enabled -Dtests=enabled
    fi
    case $machine in
    mingw) set -- "$@" -Dnative_processors=x86_64_v3 ;;
    musl | x87) set -- "$@" -Dnative_processors=own ;;
    esac
    set_up "$folder" "$here/../.." -Dopencl=disabled -Dnative=enabled -Dimage_module=disabled -Dplots=disabled -Dweb=disabled \
        -Dopenimageio=disabled -Ddesktop=disabled "$@" || return 1
    for library in "$folder"/*.dll; do
        [ ! -f "$library" ] || sh "$here/../install/check_exports.sh" "$library" || return 1
    done
}

# Tests that take an emulator minutes of processor time each.
long_tests="conformance|convergence_trace|encodes_host|field|fit_state_host|forged|gradients_host|layouts|library|memory|native"
long_tests="$long_tests|native_faults|packet_encode|rows|scalar_rdo_host|scenes_host|timing|visual_loss_host"

# Tests whose references have the bits that clang keeps in registers of i386, against values that were stored as floats and doubles.
tests_of_stored_bits="elementary|elementary_single|render_host"

# Names of the tests to run, each on a line: any_build has those of code that is the same for all machines.
test_names() {
    if [ "$how" = quick ]; then
        printf '%s\n' conformance_set "fuzz reader" "fuzz writer"
        return
    fi
    left_out=$long_tests
    case "$how $machine" in
    whole\ * | *\ i386 | *\ mingw | *\ musl | *\ x87) left_out= ;;
    esac
    [ "$machine" != clang-i386 ] || left_out="$left_out|$tests_of_stored_bits"
    meson test -C "$folder" --no-rebuild --no-suite any_build --list | sed -n 's|^gscl:.* / ||p' | grep -vxE "$left_out"
}

row() {
    printf '| %-10s | %-6s | %-15s | %-18s | %-9s | %-20s |\n' "$machine" "$@"
}

encodes() {
    set --
    [ "$how" != quick ] || set -- 33x2 rgba blend-alpha
    encoded=$(sh "$here/check_golden.sh" "$machine" "$@" 2>>"$log") && add 1 0 || add 0 1
}

tool_files() {
    program=$(ls "$folder/gscl" "$folder/gscl.exe" 2>/dev/null)
    files=$(sh "$here/tool_files.sh" sh "$here/on_machine.sh" "$machine" "$program" 2>>"$log") && add 1 0 || add 0 1
}

# add PASSED FAILED
add() {
    passed=$((passed + $1)) not=$((not + $2))
}

# An emulator takes ten times as long; a limit only ends a test that hangs.
passed=0 not=0 encoded=- files=-
if build >"$log" 2>&1; then
    test_names | tr '\n' '\0' |
        xargs -0 meson test -C "$folder" --no-rebuild --print-errorlogs --timeout-multiplier 2 >>"$log" 2>&1
    failed=$?
    right=$(sed -n 's/^# decode-host: \(.*\) files right.*/\1/p' "$folder/meson-logs/testlog.txt")
    [ -n "$right" ] || failed=1
    encodes
    [ "$how" = quick ] || tool_files
    echo "$passed $not" >"$folder/meson-logs/encodes.txt"
    [ "$not" = 0 ] || failed=1
    counts=$(python3 "$here/../count_results.py" "$results")
    row yes "${right:-none}" "$encoded" "$files" "${counts% *} passed, ${counts#* } failed"
else
    failed=1
    row no - - - -
fi
[ "$failed" = 0 ] || {
    echo "of $log:"
    grep -E '^(FAILED|not ok|ERROR)|error:|^ *[0-9/]+ gscl:.* (FAIL|ERROR|TIMEOUT) ' "$log" | sort -u | head -n 20
    echo "..."
    tail -n 5 "$log"
} | sed 's/^/    /'
exit "$failed"
