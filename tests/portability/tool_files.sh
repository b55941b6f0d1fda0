#!/bin/sh
# Encodes and decodes files with the tool of another machine, and prints a line of counts: tool_files.sh COMMAND...
#
# COMMAND is the tool, with what runs it.  The files are a PNG of 8 and one of 16 bits, a JPEG and a PNM, one with a name that is not
# ASCII, and one that comes from and goes to a pipe.  Each is drawn by the tool itself, which reads no PNM without its image module:
# that one is compared with a PNG.
set -u
example=$(cd "$(dirname "$0")/.." && pwd)/conformance/files/example.gscl
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp "$example" "$work/example.gscl"
cd "$work" || exit 1
command=$*
run() {
    $command "$@"
}

# there_and_back IMAGE: draws an image, encodes it, decodes it again into another of its kind, and measures their likeness.
there_and_back() {
    run decode example.gscl --size 48x32 ${2:-} -o "$1" && run encode --device host --effort 1 "$1" -o "$1.gscl" &&
        run decode "$1.gscl" -o "again-$1" && run compare "$1" "again-$1" >measures && [ -s "$1.gscl" ] && [ -s "again-$1" ] &&
        awk '/^PSNR/ { exit !($2 == "inf" || $2 > 25) }' measures
}

through_pipes() {
    run encode --device host --effort 1 - -o - <a.png >piped.gscl && cmp piped.gscl a.png.gscl >&2 &&
        run decode - -o - <piped.gscl >piped.png && cmp piped.png again-a.png >&2
}

writes_pnm() {
    run decode a.png.gscl -o a.ppm && [ "$(head -c 2 a.ppm)" = P6 ] && [ "$(wc -c <a.ppm)" -eq $((13 + 3 * 48 * 32)) ]
}

passed=0
failed=
check() {
    name=$1
    shift
    if "$@" 2>>"$work/log"; then passed=$((passed + 1)); else failed="$failed $name"; fi
}
check png there_and_back a.png
check jpeg there_and_back b.jpg
check 16-bit there_and_back c.png "--depth 16"
check names there_and_back ä日本.png
check pipes through_pipes
check pnm writes_pnm
echo "$passed of 6"
[ -z "$failed" ] || { echo "failed:$failed"; cat "$work/log"; } >&2
[ -z "$failed" ]
