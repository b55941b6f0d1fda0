#!/bin/sh
# Tests the wheel that install.sh built in a folder, on a machine where nothing else is installed: test_wheel.sh FOLDER
set -eu
here=$(cd "$(dirname "$0")" && pwd)
folder=$(cd "$1" && pwd)
machine=$(uname -m)
wheel=$(echo "$folder"/wheel/gscl-*.whl)

fail() {
    echo "test_wheel: $*" >&2
    exit 1
}

# It says that it fits the stable interface of CPython 3.10, and glibc 2.28.
case $wheel in
*"-cp310-abi3-manylinux_2_28_$machine.whl") ;;
*) fail "the tags of $wheel" ;;
esac
# auditwheel names the oldest policy that the symbols and libraries allow.
policy=$("$folder/venv/bin/auditwheel" show "$wheel" | tr -d '\n' | sed -n 's/.*platform tag: *"manylinux_2_\([0-9]*\)_.*/\1/p')
[ "${policy:-99}" -le 28 ] || fail "needs a newer system than manylinux_2_28: $("$folder/venv/bin/auditwheel" show "$wheel")"

# A virtual environment with the wheel and what it says that it needs, for a program that finds neither OpenCL nor a home.
rm -rf "$folder/clean"
python3 -m venv "$folder/clean"
"$folder/clean/bin/pip" --disable-pip-version-check --quiet install --constraint "$here/requirements.txt" "$wheel"
cd "$folder/clean"
encode() {
    env -i HOME=/nonexistent OCL_ICD_VENDORS=/nonexistent "$@" - <<'END'
import numpy

import gscl

(device,) = gscl.devices()
assert device.id == "host", device
y, x = numpy.mgrid[0:32, 0:48]
picture = numpy.stack([4 * x, 6 * y, 255 - 2 * x - 2 * y], axis=-1).astype(numpy.uint8)
data = gscl.encode(picture, bytes=200, effort=0, device="host")
report = data.report
drawn = gscl.decode(data)
assert len(data) <= 200 and report.psnr > 35 and gscl.compare(picture, drawn).psnr > 35, report
assert gscl.decode(data, size=(480, 320)).shape == (320, 480, 3)
print(f"{len(data)} bytes, {report.psnr:.2f} dB in {report.seconds:.2f} s: {device.name}")
END
}

encode bin/python

# It has kernels for each kind of processor: QEMU is those that this one is not.
[ "$machine" = x86_64 ] || exit 0
for kind in Nehalem:x86_64_v2 Haswell:x86_64_v3; do
    encode qemu-x86_64 -cpu "${kind%:*}" bin/python | tee encoded
    grep -q "${kind#*:}$" encoded || fail "no kernels for ${kind#*:}"
done
