#!/bin/sh
# Tests the tool of a build with many image files, in the virtual environment of a folder: test.sh BUILD FOLDER
#
# Writes FOLDER/formats.xml, which tests/count_results.py reads.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
build=$(cd "$1" && pwd)
folder=$(cd "$2" && pwd)
export GSCL="$build/gscl" READ_IMAGES="$build/tests/read_images" PYTHONDONTWRITEBYTECODE=1 OPENCV_LOG_LEVEL=OFF
rm -f "$folder/formats.xml"
cd "$here"
exec "$folder/venv/bin/python" -m pytest -q -p no:cacheprovider --junitxml="$folder/formats.xml" .
