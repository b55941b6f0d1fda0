#!/bin/sh
# Runs unit tests of a build with AddressSanitizer and checks for memory leaks: check_leaks.sh BUILD
#
# The leak checker stops all threads of the process, which some machines forbid and which sometimes fails beside the threads
# of an OpenCL driver.  Such a failure of the checker is not a failure of the test.
set -u
build=$1
export ASAN_OPTIONS=detect_leaks=1 CMOCKA_MESSAGE_OUTPUT=TAP POCL_SIGFPE_HANDLER=0
export LSAN_OPTIONS=suppressions=$PWD/tests/lsan.supp:print_suppressions=0
log=$(mktemp)
trap 'rm -f "$log"' EXIT
# Every test of the host but long ones that allocate as these do: accuracy, conformance, convergence_trace, gradients,
# render, scalar_rdo, timing.  test_memory has a failing allocation in each of its encodes and decodes.
for test in fuzz_reader test_format test_format_coding test_kmeans test_metrics test_quality_search test_quantise \
    test_flat_background test_level_residual test_fit_state test_codebook test_device test_launch test_pinned test_memory \
    test_library test_interface test_faults test_native_faults; do
    for attempt in 1 2 3; do
        # Unit tests ignore the arguments, which are for the fuzz targets.  Their kernels are in the cache.
        POCL_CACHE_DIR=$build/tests/pocl/${test#test_} "$build/tests/$test" tests/fuzz/corpus/* >"$log" 2>&1 && continue 2
        if ! grep -q 'LeakSanitizer has encountered a fatal error' "$log"; then
            cat "$log"
            exit 1
        fi
    done
    echo "$test: the leak checker does not work on this machine"
done
