#!/bin/sh
# Builds gscl and encodes an image: sh tests/quickstart.sh [IMAGE]
#
# Installs missing packages (Debian), builds in build/, encodes and decodes IMAGE (default: the project's sample image),
# and prints the size and the quality of the file.  The results are in out/.
set -eu

image=${1:-}
if [ -n "$image" ]; then
    [ -r "$image" ] || { echo "quickstart: $image: cannot be read; name an image file" >&2; exit 1; }
    image=$(cd "$(dirname "$image")" && pwd)/$(basename "$image")
fi
cd "$(dirname "$0")/.."
. tests/setup.sh
install_packages $build_packages

echo "quickstart: building"
log=$(mktemp)
{
    [ -f build/build.ninja ] || meson setup build -Dnative_processors=own
    ninja -C build gscl gscl-imageio.so tests/sample/make_sample tests/sample/side_by_side
} >"$log" 2>&1 || { tail -n 30 "$log" >&2; exit 1; }
rm -f "$log"

mkdir -p out
if [ -z "$image" ]; then
    image=out/sample.png
    build/tests/sample/make_sample "$image"
fi
name=$(basename "$image")
result=out/${name%.*}

echo "quickstart: encoding $image"
encoded=$(build/gscl encode "$image" -o "$result.gscl" --json)
started=$(date +%s.%N)
build/gscl decode "$result.gscl" -o "$result.decoded.png"
finished=$(date +%s.%N)
compared=$(build/gscl compare "$image" "$result.decoded.png" --json)
build/tests/sample/side_by_side "$image" "$result.decoded.png" "$result.side_by_side.png"

python3 - "$encoded" "$compared" "$started" "$finished" <<'END'
import json
import sys

encoded, compared = json.loads(sys.argv[1]), json.loads(sys.argv[2])
decode_seconds = float(sys.argv[4]) - float(sys.argv[3])
ms_ssim = compared["ms_ssim"]
print(f"""
rate        {encoded['bpp']:.4f} bpp, {encoded['bytes']} bytes, {encoded['splats']} splats ({encoded['width']}x{encoded['height']})
quality     PSNR {compared['psnr']:.2f} dB, MS-SSIM {'-' if ms_ssim is None else f'{ms_ssim:.4f}'}
encode      {encoded['seconds']:.2f} s
decode      {decode_seconds:.2f} s""")
END
echo "file        $result.gscl"
echo "decoded     $result.decoded.png"
echo "compare     $result.side_by_side.png (original | decoded)"
echo "browser     sh host/web/serve.sh shows the demonstration page: zoom, splats, the first part of a file"
