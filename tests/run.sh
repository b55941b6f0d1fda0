#!/bin/sh
# Runs every test: sh tests/run.sh
#
# Installs missing packages (Debian), builds in folders build*/ and ends with one line, "N passed, N failed".
# Exits with 0 only if no test failed.
set -u
cd "$(dirname "$0")/.."
. tests/setup.sh
install_packages $build_packages $test_packages || { echo "0 passed, 1 failed"; exit 1; }

# All tests but those of tests/devices run on PoCL, whatever else is installed.
[ ! -f /etc/OpenCL/vendors/pocl.icd ] || export OCL_ICD_VENDORS=/etc/OpenCL/vendors/pocl.icd

passed=0
failed=0
log=$(mktemp)
trap 'rm -f "$log"' EXIT

# check NAME COMMAND...: one test, whose output is printed only when it fails.
check() {
    name=$1
    shift
    if "$@" >"$log" 2>&1; then
        passed=$((passed + 1))
        echo "ok      $name"
    else
        failed=$((failed + 1))
        echo "FAILED  $name"
        tail -n 40 "$log" | sed 's/^/        /'
    fi
}

# build FOLDER [MESON OPTIONS]
build() {
    folder=$1
    shift
    # Reconfigures an old folder, so that packages installed since are found.
    again=
    [ ! -f "$folder/build.ninja" ] || again=--reconfigure
    meson setup $again "$folder" "$@" && ninja -C "$folder"
}

# add_counts FILE: adds each single test of a file of results to the count.
add_counts() {
    counts=$(python3 tests/count_results.py "$1")
    passed=$((passed + ${counts% *}))
    failed=$((failed + ${counts#* }))
}

# The kernels are the same in all builds.
kernels=$PWD/build-test/kernels
with_cache="$PWD/tests/with_cache.py $kernels"

# suite FOLDER [MESON TEST ARGUMENTS]
suite() {
    folder=$1
    shift
    results=$folder/meson-logs/testlog-with_cache.py.json # meson names it after the wrapper
    rm -f "$results"
    meson test -C "$folder" --no-rebuild --print-errorlogs --wrapper "$with_cache" "$@"
    add_counts "$results"
}

# The quick start of the README, in build/ and out/.
check "quickstart" sh tests/quickstart.sh

# All tests of a release build.
check "build" build build-test -Dtool=enabled -Dtests=enabled -Dweb=enabled -Dopenimageio=enabled -Ddesktop=enabled
suite build-test
check "valgrind" sh tests/check_valgrind.sh build-test
check "other OpenCL implementations" sh tests/devices/run.sh --quick build-test
check "install" sh tests/install/test_install.sh build-test
check "exported symbols" sh tests/install/check_exports.sh build-test/libgscl.so
check "public headers" sh tests/install/check_headers.sh host/include
check "format of sources" sh tests/check_format.sh
check "clang-tidy" sh tests/check_tidy.sh build-test
check "analyzer of gcc" sh tests/check_analyzer.sh build-test
check "rooms" sh -c 'python3 tests/structure/check_rooms.py build-test/libgscl.so.*.p build-test/libgscl-tool.a.p'
check "rooms are checked" python3 tests/structure/test_check_rooms.py

# The Python package, in a virtual environment.
rm -f build-test/python/results.xml
check "python wheel" sh tests/python/install.sh build-test/python
POCL_CACHE_DIR=$PWD/build-test/python/pocl $with_cache sh tests/python/test.sh build-test/python
add_counts build-test/python/results.xml

# Image files of all kinds, by many writers.
rm -f build-test/python/formats.xml
check "writers and readers of image files" sh tests/formats/install.sh build-test/python
POCL_CACHE_DIR=$PWD/build-test/python/pocl $with_cache sh tests/formats/test.sh build-test build-test/python
add_counts build-test/python/formats.xml

# Host code under ASan and UBSan, with small hard cases; check_leaks.sh checks for leaks.
check "build with sanitizers" build build-sanitize \
    --buildtype=debugoptimized -Db_sanitize=address,undefined -Dtests=enabled -Dweb=disabled
export ASAN_OPTIONS=detect_stack_use_after_return=1:detect_leaks=0 UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1
export STABILITY_SMALL=1
suite build-sanitize --suite unit --suite fuzz --suite conformance --suite stability
unset ASAN_OPTIONS UBSAN_OPTIONS STABILITY_SMALL
check "no data races" sh tests/check_threads.sh build-thread
check "no leaks" sh tests/check_leaks.sh "$PWD/build-sanitize"

# The library without OpenCL: here, and on other machines.
check "build without OpenCL" build build-decoder -Dopencl=disabled -Dtool=disabled -Dtests=enabled -Dweb=disabled \
    -Dopenimageio=disabled -Ddesktop=disabled
export STABILITY_SMALL=1
suite build-decoder
unset STABILITY_SMALL
check "library without OpenCL" sh tests/install/test_without_opencl.sh build-decoder
sh tests/portability/run.sh --quick
for machine in $quick_machines; do
    add_counts "build-portability/$machine/meson-logs/testlog.json"
done

# The library alone needs no C++ compiler.
CXX=false check "library without C++" build build-library -Ddebug=true -Dtool=disabled -Dtests=disabled
check "install of the library" sh tests/install/test_install.sh build-library
check "reproducible and hardened build" sh tests/install/test_reproducible.sh
check "binary interface" sh tests/install/check_abi.sh build-library/libgscl.so

for compiler in gcc:g++ clang:clang++; do
    CC=${compiler%:*} CXX=${compiler#*:} check "no warnings from ${compiler%:*}" \
        build "build-${compiler%:*}" --werror -Dtool=enabled -Dtests=enabled -Dweb=disabled
done

echo "$passed passed, $failed failed"
[ "$failed" = 0 ]
