#!/bin/sh
# Encodes the images of tests/unit/golden.txt on another machine: check_golden.sh MACHINE [--all | CASE...]
#
# machine.sh has built tests/golden, with the encoder, in build-portability/MACHINE.  Without cases a few small ones are encoded, with
# --all all of them, in half an hour of processor time in qemu-user.  Prints how many files are those of golden.txt, and the mean
# difference of PSNR where not all are.  Machines in `exact` promise the same files: they fuse multiplications and additions, and
# compute floats as floats.  Others must give the same file twice.
set -u
here=$(cd "$(dirname "$0")" && pwd)
machine=$1
shift
exact="aarch64 armhf mingw musl ppc64 riscv64 s390x"
# Both profiles, an alpha channel, blending by alpha and the visual loss.
[ $# -gt 0 ] || set -- 33x2 rgba blend-alpha paper tune-visual
[ "$1" != --all ] || shift
golden=$here/../unit/golden.txt
made=$(mktemp)
trap 'rm -f "$made"' EXIT
program=$(ls "$here/../../build-portability/$machine/tests/golden" "$here/../../build-portability/$machine/tests/golden.exe" 2>/dev/null)
encode() {
    sh "$here/on_machine.sh" "$machine" "$program" "$@" | tr -d '\r'
}

encode "$@" >"$made"
[ -s "$made" ] || { echo failed; exit 1; }
grep -vxFf "$golden" "$made" >&2
awk 'FNR == NR { hash[$1] = $2; psnr[$1] = $3; next }
    { count++; same += $2 == hash[$1]; sum += $3 - psnr[$1] }
    END { printf "%d of %d", same, count; if (same < count) printf ", %+.2f dB", sum / count; print "" }' "$golden" "$made"
[ $# = 0 ] || [ "$(wc -l <"$made")" = $# ] || exit 1
case " $exact " in
*" $machine "*) ! grep -qvxFf "$golden" "$made" ;;
*) [ "$(encode 33x2)" = "$(encode 33x2)" ] ;;
esac
