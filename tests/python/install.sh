#!/bin/sh
# Builds a wheel of host/python for many machines and installs it, with pinned packages of the tests, in a virtual environment:
# install.sh FOLDER [OPTIONS OF build_wheel.sh]
#
# FOLDER/without_kernels gets the package as the machine's own compiler makes it, of a library without kernels for processors.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
mkdir -p "$1"
folder=$(cd "$1" && pwd)
shift
[ -x "$folder/venv/bin/pip" ] || python3 -m venv "$folder/venv"
pip="$folder/venv/bin/pip --disable-pip-version-check --quiet"

$pip install -r "$here/requirements.txt"
export PIP_CONSTRAINT="$here/requirements.txt" PIP_BUILD_CONSTRAINT="$here/requirements.txt"
sh "$here/../../host/python/build_wheel.sh" "$folder/venv/bin/python" "$folder/wheel" "$@"
$pip install --force-reinstall --no-deps "$folder"/wheel/gscl-*.whl
$pip install --upgrade --no-deps --target "$folder/without_kernels" -Cbuild-dir="$folder/build" \
    -Csetup-args=-Dgscl:native=disabled -Csetup-args=-Dbuildtype=debug "$here/../../host/python"
