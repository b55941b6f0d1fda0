#!/bin/sh
# Runs the tests: sh tests/run.sh [--whole]
#
# Installs missing packages (Debian), builds in folders build*/ and ends with one line, "N passed, N failed".
# Exits with 0 only if no test failed.
#
# Without --whole the hard cases run on the device "host", and those that take PoCL many minutes do not run on PoCL (the suite
# `whole` of tests/stability/meson.build); every kernel is tested on both.
#
# What runs after what: release_build first, and then two lanes at once, each from top to bottom.  No lane waits for another,
# and none needs what another writes.  Those in kernel_lane find kernels that tests above them have compiled.
set -u
cd "$(dirname "$0")/.."
. tests/setup.sh

# The lanes test this build.  Newer compilers than Debian 12's may have further warnings: then the tests run all the same.
release_build() {
    set -- -Dtool=enabled -Dtests=enabled -Dweb=enabled -Dweb_encoder=enabled -Dopenimageio=enabled -Ddesktop=enabled
    CC=gcc CXX=g++ check "build, no warnings from gcc" build build-test "$@" -Dwerror=true ||
        check "build with warnings" build build-test "$@" -Dwerror=false
}

kernel_lane() {
    suite build-test all_but_kernels $without_whole --no-suite kernels
    sanitizers
}

build_lane() {
    check "quickstart" sh tests/quickstart.sh # of the README, in build/ and out/
    sources
    suite build-test kernels $without_whole --suite kernels
    library_without_opencl
    library_alone
    # Its warnings do not depend on optimisation.
    CC=clang CXX=clang++ check "no warnings from clang" \
        build build-clang -Dwerror=true -Doptimization=0 -Db_ndebug=true -Dtool=enabled -Dtests=enabled -Dweb=disabled \
        -Dnative=disabled
    check "no data races" sh tests/check_threads.sh build-thread
    check "valgrind" sh tests/check_valgrind.sh build-test
    check "fuzz targets of OSS-Fuzz" sh tests/fuzz/test_oss_fuzz.sh ${without_whole:+image options}
    check "other OpenCL implementations" sh tests/devices/run.sh --quick build-test
    check "measurements of a GPU, without one" sh tests/devices/test_gpu_day.sh build-test
    python_package
    web_package
    image_files
    packages
}

# Checks of the sources, and of the release build as it is.
sources() {
    check "install" sh tests/install/test_install.sh build-test
    check "exported symbols" sh tests/install/check_exports.sh build-test/libgscl.so build-test/libgscl.a
    check "public headers" sh tests/install/check_headers.sh host/include
    check "format of sources" sh tests/check_format.sh
    check "clang-tidy" sh tests/check_tidy.sh build-test
    check "analyzer of gcc" sh tests/check_analyzer.sh build-test
    check "rooms" sh -c 'python3 tests/structure/check_rooms.py build-test/libgscl.so.*.p build-test/libgscl-tool.a.p'
    check "rooms are checked" python3 tests/structure/test_check_rooms.py
    check "kernels for GPUs" python3 tests/targets/check_targets.py --quick build-test/tests/targets/list_programs
    check "kernels for other processors" python3 tests/targets/check_native.py --quick
}

# The package for web pages among bundlers and frameworks, which npm brings.  Debian 12 has an older Node than they need.
web_package() {
    if ! command -v npm >/dev/null || ! node -e 'process.exit(+(parseInt(process.versions.node) < 20))'; then
        echo "left out  web package with packages of npm, which need npm and Node 20" | print_whole
        return
    fi
    tap_suite "web package with packages of npm" node tests/web/test_packages.mjs build-test/host/web build-test/packages
    tap_suite "web package for sites" node tests/web/test_sites.mjs build-test/host/web build-test/packages
    [ -n "$without_whole" ] ||
        tap_suite "web package in projects of frameworks" node tests/web/test_frameworks.mjs build-test/host/web build-test/packages
}

# The Python package, in a virtual environment.
python_package() {
    check "python wheel" sh tests/python/install.sh build-test/python
    check "python wheel alone" sh tests/python/test_wheel.sh build-test/python
    pytest_suite results.xml sh tests/python/test.sh build-test/python
    check "links are checked" python3 tests/structure/test_check_links.py
    check "site" site c python
    [ -n "$without_whole" ] || check "site with the web package" site c python web
}

# site PARTS...: the documents with these references, in the same environment.
site() {
    SITE_PYTHON=build-test/python/venv/bin/python SITE_PARTS=$* sh host/site/build.sh build-test/site build-test
}

# Packages for publication, of the last commit.
packages() {
    check "packages" sh tests/packaging/run.sh $([ -n "$without_whole" ] || echo --whole) build-test/packaging build-test/host/web
}

# Image files of all kinds, by many writers, in the same environment.
image_files() {
    check "writers and readers of image files" sh tests/formats/install.sh build-test/python
    pytest_suite formats.xml sh tests/formats/test.sh build-test build-test/python
}

# The library and its kernels under ASan and UBSan, with small hard cases on the device "host"; check_leaks.sh, after the
# tests whose kernels it finds, looks for leaks.
sanitizers() {
    check "build with sanitizers" build build-sanitize \
        --buildtype=debugoptimized -Db_sanitize=address,undefined -Dtests=enabled -Dweb=disabled \
        -Dopenimageio=disabled -Ddesktop=disabled -Dplots=disabled -Dnative_processors=own
    export ASAN_OPTIONS=detect_stack_use_after_return=1:detect_leaks=0 UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1
    export STABILITY_SMALL=1
    suite build-sanitize sanitized --suite unit --suite fuzz --suite conformance --suite stability --no-suite opencl --no-suite whole
    unset ASAN_OPTIONS UBSAN_OPTIONS STABILITY_SMALL
    check "no leaks" sh tests/check_leaks.sh "$PWD/build-sanitize"
}

# Here, and on other machines.
library_without_opencl() {
    check "build that only decodes" build build-decoder -Dopencl=disabled -Dnative=disabled -Dtool=disabled -Dtests=enabled \
        -Dweb=disabled -Dopenimageio=disabled -Ddesktop=disabled
    check "build without OpenCL" build build-native -Dopencl=disabled -Dnative=enabled -Dnative_processors=own \
        -Dtool=disabled -Dtests=enabled -Dweb=disabled -Dopenimageio=disabled -Ddesktop=disabled
    export STABILITY_SMALL=1
    suite build-decoder all --no-suite any_build
    suite build-native all --no-suite any_build
    unset STABILITY_SMALL
    check "library that only decodes" sh tests/install/test_without_opencl.sh build-decoder
    show "other machines" sh tests/portability/run.sh --quick
    for machine in $quick_machines; do
        add_counts "build-portability/$machine/meson-logs/testlog.json"
        add $(cat "build-portability/$machine/meson-logs/encodes.txt" || echo 0 1)
    done
}

# The library without the tool needs no C++ compiler and no other library: no description of one is found.
library_alone() {
    CXX=false PKG_CONFIG_LIBDIR=/nonexistent check "library alone" build build-library -Ddebug=true -Dtool=disabled \
        -Dtests=disabled -Dnative_processors=own
    check "nothing beside the library" sh tests/install/test_alone.sh build-library
    check "install of the library" sh tests/install/test_install.sh build-library
    check "reproducible and hardened build" sh tests/install/test_reproducible.sh
    check "binary interface" sh tests/install/check_abi.sh build-library/libgscl.so
}

# ---- How they run -----------------------------------------------------------------------------------

# build FOLDER [MESON OPTIONS]
build() {
    folder=$1
    shift
    # Reconfigures an old folder, so that packages installed since are found.
    again=
    [ ! -f "$folder/build.ninja" ] || again=--reconfigure
    meson setup $again "$folder" "$@" && ninja -C "$folder"
}

# timed COMMAND...: runs it with its output in $log, and sets $seconds.
timed() {
    began=$(date +%s)
    "$@" >"$log" 2>&1
    code=$?
    seconds=$(($(date +%s) - began))
    return $code
}

# print_whole: prints standard input, with no line of another lane in between.
print_whole() {
    cat >"$log.whole"
    flock "$work/output" cat "$log.whole"
}

# add PASSED FAILED: one line of counts, written at once.
add() {
    echo "$1 $2" >>"$work/counts"
}

# check NAME COMMAND...: one test, whose output is printed only when it fails.
check() {
    name=$1
    shift
    if timed "$@"; then
        add 1 0
        echo "ok      $name ($seconds s)" | print_whole
    else
        add 0 1
        { echo "FAILED  $name ($seconds s)" && tail -n 40 "$log" | sed 's/^/        /'; } | print_whole
        return 1
    fi
}

# show NAME COMMAND...: prints all output; the caller counts its tests.
show() {
    name=$1
    shift
    timed "$@"
    { cat "$log" && echo "ran     $name ($seconds s)"; } | print_whole
}

# add_counts FILE: adds each single test of a file of results to the count.
add_counts() {
    add $(python3 tests/count_results.py "$1" || echo 0 1)
}

# The kernels are the same in all builds.
with_cache="$PWD/tests/with_cache.py $PWD/build-test/kernels"

# suite FOLDER LOGS [MESON TEST ARGUMENTS]: LOGS names the logs, which are not those of another suite in the folder.
suite() {
    folder=$1
    logs=$2
    results=$folder/meson-logs/$logs-with_cache.py.json # meson adds the name of the wrapper
    shift 2
    rm -f "$results"
    show "tests of $folder" meson test -C "$folder" --logbase "$logs" --no-rebuild --print-errorlogs --wrapper "$with_cache" "$@"
    add_counts "$results"
}

# tap_suite NAME COMMAND...: a program that prints TAP.
tap_suite() {
    name=$1
    shift
    show "$name" "$@"
    add "$(grep -c '^ok ' "$log")" "$(awk -F '[.]' '/^1[.][.]/ { planned = $3 } /^ok / { passed++ } END { print planned ? planned - passed : 1 }' "$log")"
}

# pytest_suite RESULTS COMMAND...: RESULTS is what the command writes in build-test/python.
pytest_suite() {
    results=build-test/python/$1
    shift
    rm -f "$results"
    show "tests in $results" env POCL_CACHE_DIR="$PWD/build-test/python/pocl" $with_cache "$@"
    add_counts "$results"
}

# The builds compile each kernel once (cl/native.py).
export KEPT_KERNELS="$PWD/build-test/kept_kernels"

# All tests but those of tests/devices run on PoCL, whatever else is installed.
[ ! -f /etc/OpenCL/vendors/pocl.icd ] || export OCL_ICD_VENDORS=/etc/OpenCL/vendors/pocl.icd

# Inherited by the lanes.
without_whole=${without_whole---no-suite whole}
[ "${1:-}" != --whole ] || without_whole=
export without_whole

# In a lane: run.sh --lane LANE WORK
if [ "${1:-}" = --lane ]; then
    work=$3
    log=$work/$2.log
    "$2"
    exit 0
fi

work=$(mktemp -d)
log=$work/release_build.log
lanes=
# Each lane is a process group, which ends with this script.
trap 'for lane in $lanes; do kill -s TERM -- "-$lane" 2>/dev/null; done; wait; rm -rf "$work"' EXIT
trap 'exit 130' INT TERM HUP

install_packages $build_packages $test_packages $target_packages $microcontroller_packages $(for machine in $quick_machines; do machine_packages "$machine"; done) ||
    { echo "0 passed, 1 failed"; exit 1; }
release_build
for lane in kernel_lane build_lane; do
    setsid sh tests/run.sh --lane "$lane" "$work" &
    lanes="$lanes $!"
done
for lane in $lanes; do
    wait "$lane" || { echo "FAILED  a lane ended before its last test"; add 0 1; }
done
lanes=
awk '{ passed += $1; failed += $2 } END { print passed " passed, " failed " failed"; exit failed > 0 }' "$work/counts"
