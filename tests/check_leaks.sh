#!/bin/sh
# Runs unit tests of a build with AddressSanitizer and looks for memory that nobody freed: check_leaks.sh BUILD
#
# The leak checker stops all threads of the process to look at them, which some machines forbid and which now and
# then fails beside the threads of an OpenCL driver: only what it finds counts, not that it could not look.
set -u
build=$1
export ASAN_OPTIONS=detect_leaks=1 CMOCKA_MESSAGE_OUTPUT=TAP POCL_SIGFPE_HANDLER=0
export LSAN_OPTIONS=suppressions=$PWD/tests/lsan.supp:print_suppressions=0
log=$(mktemp)
trap 'rm -f "$log"' EXIT
for test in fuzz_format test_format test_format_coding test_kmeans test_metrics test_library; do
    for attempt in 1 2 3; do
        # Unit tests take no arguments and do not look at them; their kernels are built already.
        POCL_CACHE_DIR=$build/tests/pocl/${test#test_} "$build/tests/$test" tests/fuzz/corpus/* >"$log" 2>&1 && continue 2
        if ! grep -q 'LeakSanitizer has encountered a fatal error' "$log"; then
            cat "$log"
            exit 1
        fi
    done
    echo "$test: this machine does not let the leak checker look"
done
