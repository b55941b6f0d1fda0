#!/bin/sh
# Writes what compiles and links a module for CPython of Windows, of its stable interface: windows_python.sh PYTHON FOLDER
#
# PYTHON: a source package of Debian, such as python3.11, which has the sources of CPython for all systems.  Writes FOLDER/include,
# FOLDER/python3.def, which lists the symbols of python3.dll, and FOLDER/libpython3.a.  Needs dpkg-dev and binutils of mingw-w64.
set -eu
package=$1
folder=$2
[ ! -f "$folder/libpython3.a" ] || exit 0
mkdir -p "$folder"
sh "$(dirname "$0")/../../tests/portability/fetch_sources.sh" "$folder/sources" "$package"
sources=$folder/sources/$package
cp -R "$sources/Include" "$folder/include"
# Since Python 3.13 it is pyconfig.h.in, which is complete but for the option of an interpreter without its lock.
cp "$sources"/PC/pyconfig.h* "$folder/include/pyconfig.h"
{
    echo 'LIBRARY python3.dll'
    echo EXPORTS
    sed -n 's/^EXPORT_FUNC(\(.*\))$/\1/p; s/^EXPORT_DATA(\(.*\))$/\1 DATA/p' "$sources/PC/python3dll.c"
} >"$folder/python3.def"
x86_64-w64-mingw32-dlltool --input-def "$folder/python3.def" --output-lib "$folder/libpython3.a"
rm -rf "$folder/sources"
