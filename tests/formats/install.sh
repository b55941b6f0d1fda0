#!/bin/sh
# Installs the writers and readers of image files, with pinned versions, in the virtual environment that
# tests/python/install.sh made in a folder: install.sh FOLDER
set -eu
here=$(cd "$(dirname "$0")" && pwd)
"$1/venv/bin/pip" --disable-pip-version-check --quiet install -r "$here/requirements.txt"
