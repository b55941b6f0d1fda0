#!/bin/sh
# A shared library exports gscl_* and nothing else: check_exports.sh LIBRARY
exported=$(nm -D --defined-only "$1" | awk '$2 != "A" { print $3 }')
if [ -z "$exported" ]; then
    echo "no symbols at all"
    exit 1
fi
if others=$(echo "$exported" | grep -v '^gscl_'); then
    echo "exported:" $others
    exit 1
fi
