#!/bin/sh
# The binary interface of a library is the stored one: check_abi.sh LIBRARY [--update]
#
# LIBRARY needs debug information (meson setup -Ddebug=true).  The stored interface, libgscl.abi, describes the functions,
# structs and enumerations of host/include as they are on x86-64.  Any difference fails.  A difference that old programs
# survive (a new function; a new field at the end of a struct with struct_size, behind the padding of the last one) is
# stored on purpose with --update; any other needs a new soname.
set -eu
library=$1
here=$(cd "$(dirname "$0")" && pwd)
stored=$here/libgscl.abi
headers=$here/../../host/include/gscl

if [ "$(uname -m)" != x86_64 ]; then
    echo "skipped: the stored interface is that of x86-64"
    exit 0
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT INT TERM
# The public headers alone define the interface; paths and line numbers stay out of it.
abidw --headers-dir "$headers" --drop-private-types --exported-interfaces-only --no-corpus-path --no-comp-dir-path \
    --no-show-locs --no-elf-needed --type-id-style hash "$library" |
    sed "s,path='[^']*host/lib/,path='," >"$work/libgscl.abi"
if [ "${2:-}" = --update ]; then
    cp "$work/libgscl.abi" "$stored"
    echo "wrote $stored"
    exit 0
fi
if ! grep -q "<class-decl name='gscl_encode_settings'" "$work/libgscl.abi"; then
    echo "$library has no debug information: configure its build with -Ddebug=true"
    exit 1
fi
if ! abidiff --no-show-locs "$stored" "$work/libgscl.abi"; then
    echo "the interface changed; if old programs survive it: sh tests/install/check_abi.sh LIBRARY --update"
    exit 1
fi
