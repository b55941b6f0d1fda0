#!/bin/sh
# Libraries give other programs the functions of the public headers and nothing else: check_exports.sh LIBRARY...
#
# libgscl.so exports them with a symbol version, a DLL without.  The members of libgscl.a call each other, so that a linker
# sees their internal functions, too: those are hidden, so that no library with libgscl.a in it exports them, and begin with
# gscl_ or gsf_, so that they have the name of nothing else.
set -eu
headers=$(dirname "$0")/../../host/include/gscl
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT INT TERM

# hidden ARCHIVE, visible ARCHIVE: names of symbols that its members define for others
hidden() { readelf -sW "$1" | awk '$5 != "LOCAL" && $6 == "HIDDEN" && $7 != "UND" { print $8 }'; }
visible() { readelf -sW "$1" | awk '$5 ~ /GLOBAL|WEAK/ && $6 != "HIDDEN" && $7 != "UND" { print $8 }'; }

# exported LIBRARY
exported() {
    case $1 in
    *.a) visible "$1" ;;
    *.dll) objdump -p "$1" | sed -n '/^\[Ordinal\/Name Pointer\]/,/^$/s/^\t\[[ 0-9]*\] //p' ;;
    *) nm -D --defined-only "$1" | awk '$2 != "A" { print $3 }' | sed 's/@@GSCL_[0-9]*$//; t; s/$/ (no version)/' ;;
    esac
}

sed -n 's/^GSCL_API .*[ *]\(gscl_[a-z_]*\)(.*/\1/p' "$headers"/*.h | sort >"$work/public"
for library in "$@"; do
    exported "$library" | sort >"$work/exported"
    if ! diff "$work/public" "$work/exported" >"$work/differences"; then
        echo "$library: <: of the public headers, but not exported; >: exported, but not of the headers"
        cat "$work/differences"
        exit 1
    fi
    case $library in
    *.a)
        [ -n "$(hidden "$library")" ] || { echo "$library: no symbol is hidden"; exit 1; }
        if others=$(hidden "$library" | grep -v '^gs\(cl\|f\)_'); then
            echo "$library: internal symbols without gscl_ or gsf_ before their names:" $others
            exit 1
        fi
        ;;
    esac
done
