#!/bin/sh
# Looks for data races with ThreadSanitizer: check_threads.sh BUILD
#
# Builds what it needs in BUILD.  Runs test_threads (contexts in eight threads), test_native (launches that threads share) and
# batches of the tool with four jobs, good and bad images, and a report, both on the device "host", with its kernels, and on
# PoCL.  Only races in PoCL's own code are passed over; kernels that PoCL compiles are not watched.
set -eu
cd "$(dirname "$0")/.."
build=$1
again=
[ ! -f "$build/build.ninja" ] || again=--reconfigure
meson setup $again "$build" --buildtype=debugoptimized -Db_sanitize=thread -Db_lundef=false -Dtests=enabled \
    -Dtool=enabled -Dweb=disabled -Ddesktop=disabled -Dopenimageio=disabled -Dplots=disabled \
    -Dnative_processors=own >/dev/null
ninja -C "$build" gscl tests/test_threads tests/test_native >/dev/null
build=$(cd "$build" && pwd)
export TSAN_OPTIONS="halt_on_error=1 exitcode=66 suppressions=$PWD/tests/tsan.supp" POCL_SIGFPE_HANDLER=0
export POCL_CACHE_DIR="$build/pocl"
mkdir -p "$POCL_CACHE_DIR"

"$build/tests/test_threads"
GOLDEN_SMALL=1 "$build/tests/test_native"

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
PYTHONDONTWRITEBYTECODE=1 python3 - "$folder" <<'END'
import pathlib
import sys
sys.path.insert(0, "tests/cli")
from images import png_bytes, scene
for i in range(12):
    pathlib.Path(sys.argv[1], f"{i}.png").write_bytes(png_bytes(scene(24 + i, 16))[:60 if i % 4 == 3 else None])
END
for device in host 0.0; do
    out=$folder/out-$device report=$folder/report-$device code=0
    "$build/gscl" encode "$folder"/*.png --out-dir "$out" --jsonl "$report" --device $device --jobs 4 --effort 0 --bytes 100 --quiet ||
        code=$?
    # 3: some of the images failed, as three of them must.
    [ "$code" = 3 ] && [ "$(ls "$out" | wc -l)" = 9 ] && [ "$(wc -l <"$report")" = 12 ] ||
        { echo "the batch on $device ended with $code"; exit 1; }
done
