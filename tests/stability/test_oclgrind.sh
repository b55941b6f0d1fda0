#!/bin/sh
# Runs hard cases of small size in oclgrind, which reports wrong API calls, accesses outside buffers and data races:
# test_oclgrind.sh PROGRAM...
# Prints TAP, one test for each program.  Its check for uninitialised values crashes in oclgrind 21.10; all other runs of
# these programs use memory filled with garbage instead (meson.build).
set -u
output=$(mktemp)
trap 'rm -f "$output"' EXIT
export CMOCKA_MESSAGE_OUTPUT=TAP STABILITY_SMALL=1 STABILITY_BLEND=alternate STABILITY_SCENES=12
unset MALLOC_PERTURB_

# oclgrind exits with 0 whatever it finds, so that any output besides the program's passed tests is a failure.
finds_nothing() {
    oclgrind --build-options -cl-opt-disable --check-api --data-races "$1" >"$output" 2>&1 &&
        ! grep -v -E '^(ok |1\.\.|# ok)' "$output" >/dev/null
}

echo "1..$#"
number=0
for program in "$@"; do
    number=$((number + 1))
    if finds_nothing "$program"; then
        echo "ok $number - $(basename "$program")"
    else
        echo "not ok $number - $(basename "$program")"
        grep -v '^ok ' "$output" | head -n 20 | sed 's/^/# /'
    fi
done
