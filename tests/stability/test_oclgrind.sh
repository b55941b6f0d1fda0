#!/bin/sh
# Runs hard cases of small size in oclgrind, which reports wrong API calls, accesses outside buffers and data races:
# test_oclgrind.sh PROGRAM...
# Speaks TAP, one test for each program.  Its check for uninitialised values crashes in oclgrind 21.10; all other runs of
# these programs are given memory that is filled with garbage instead (meson.build).
set -u
said=$(mktemp)
trap 'rm -f "$said"' EXIT
export CMOCKA_MESSAGE_OUTPUT=TAP STABILITY_SMALL=1 STABILITY_BLEND=alternate STABILITY_SCENES=12
unset MALLOC_PERTURB_

# oclgrind exits with 0 whatever it finds: nothing but the program's own good results may be said.
silent() {
    timeout -k 10 400 oclgrind --build-options -cl-opt-disable --check-api --data-races "$1" >"$said" 2>&1 &&
        ! grep -v -E '^(ok |1\.\.|# ok)' "$said" >/dev/null
}

echo "1..$#"
number=0
for program in "$@"; do
    number=$((number + 1))
    if silent "$program"; then
        echo "ok $number - $(basename "$program")"
    else
        echo "not ok $number - $(basename "$program")"
        grep -v '^ok ' "$said" | head -n 20 | sed 's/^/# /'
    fi
done
