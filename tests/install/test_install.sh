#!/bin/sh
# Installs a build folder into a temporary prefix and uses it as another project would: test_install.sh BUILD
# Builds and runs the example against the shared and against the static library, and the example of the header; runs the
# tool when there is one.
set -eu
build=$1
source=$(cd "$(dirname "$0")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT INT TERM

DESTDIR=$work meson install -C "$build" --quiet
library=$(find "$work" -name libgscl.so)
prefix=${library%/lib/*}
libdir=$(dirname "$library")

for file in mime/packages/gscl.xml misc/gscl.magic; do
    test -f "$prefix/share/$file"
done

# The files contain paths for an installation in /, not in $work.
export PKG_CONFIG_PATH="$libdir/pkgconfig" PKG_CONFIG_SYSROOT_DIR="$work"
flags="-std=c99 -Wall -Wextra -Werror -pedantic $source/tests/example/encode_decode.c"

echo "shared:"
cc $flags $(pkg-config --cflags --libs gscl) -o "$work/shared"
LD_LIBRARY_PATH=$libdir "$work/shared"
echo "example of the header:"
sh "$source/tests/install/header_example.sh" "$prefix/include/gscl/gscl.h" >"$work/header.c"
cc -std=c99 -Wall -Wextra -Werror -pedantic "$work/header.c" $(pkg-config --cflags --libs gscl) -o "$work/header"
LD_LIBRARY_PATH=$libdir "$work/header"
echo "static:"
rm "$libdir"/libgscl.so* # so that -lgscl means libgscl.a
cc $flags $(pkg-config --cflags --libs --static gscl) -o "$work/static"
"$work/static"

if [ -x "$prefix/bin/gscl" ]; then
    echo "tool:"
    DESTDIR=$work meson install -C "$build" --quiet # the shared library again
    "$prefix/bin/gscl" devices
fi
