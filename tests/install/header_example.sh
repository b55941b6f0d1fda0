#!/bin/sh
# Prints the example in the comment at the top of gscl.h: header_example.sh HEADER
sed -n '/^ \*     #include/,/^ \*     }$/s/^ \*     //p' "$1" | grep . || {
    echo "$1 has no example" >&2
    exit 1
}
