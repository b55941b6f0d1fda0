#!/bin/sh
# A shared library exports gscl_* with a symbol version and nothing else: check_exports.sh LIBRARY
exported=$(nm -D --defined-only "$1" | awk '$2 != "A" { print $3 }')
if [ -z "$exported" ]; then
    echo "no symbols at all"
    exit 1
fi
if others=$(echo "$exported" | grep -v '^gscl_[a-z_]*@@GSCL_[0-9]*$'); then
    echo "exported without a version, or not gscl's:" $others
    exit 1
fi
