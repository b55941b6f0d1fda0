#!/bin/sh
# Builds a wheel of host/python and installs it, with pinned packages of the tests, in a virtual environment:
# install.sh FOLDER
set -eu
here=$(cd "$(dirname "$0")" && pwd)
mkdir -p "$1"
folder=$(cd "$1" && pwd)
[ -x "$folder/venv/bin/pip" ] || python3 -m venv "$folder/venv"
pip="$folder/venv/bin/pip --disable-pip-version-check --quiet"

$pip install -r "$here/requirements.txt"
rm -rf "$folder/wheel"
PIP_CONSTRAINT=$here/requirements.txt PIP_BUILD_CONSTRAINT=$here/requirements.txt \
    $pip wheel --no-deps --wheel-dir "$folder/wheel" "$here/../../host/python"
$pip install --force-reinstall --no-deps "$folder"/wheel/gscl-*.whl
