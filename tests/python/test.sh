#!/bin/sh
# Tests the package that install.sh installed in a folder: test.sh FOLDER [CACHES]
#
# Writes FOLDER/results.xml, which tests/count_results.py reads.  Begins with the compiled kernels of other tests in the
# folder CACHES, if there is one.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
folder=$(cd "$1" && pwd)
export POCL_CACHE_DIR="$folder/pocl" POCL_SIGFPE_HANDLER=0 PYTHONDONTWRITEBYTECODE=1
if [ ! -d "$POCL_CACHE_DIR" ]; then
    mkdir "$POCL_CACHE_DIR"
    for cache in encode effects forms formats; do
        [ ! -d "${2:-}/$cache" ] || cp -Rn "$2/$cache/." "$POCL_CACHE_DIR/"
    done
fi
rm -f "$folder/results.xml"
cd "$folder"
exec venv/bin/python -m pytest -q -p no:cacheprovider -W error --junitxml=results.xml "$here"
