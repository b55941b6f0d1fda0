#!/bin/sh
# Tests the package that install.sh installed in a folder of the build folder: test.sh FOLDER
#
# Writes FOLDER/results.xml, which tests/count_results.py reads.  GSCL names the tool; default: that of the build folder.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
folder=$(cd "$1" && pwd)
export POCL_CACHE_DIR="$folder/pocl" POCL_SIGFPE_HANDLER=0 PYTHONDONTWRITEBYTECODE=1
export GSCL="${GSCL:-$folder/../gscl}"
rm -f "$folder/results.xml"
cd "$folder"
exec venv/bin/python -m pytest -q -p no:cacheprovider -W error --junitxml=results.xml "$here"
