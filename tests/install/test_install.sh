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

# OpenCL is opened at run time: nothing is linked with it.
for linked in "$library" "$prefix"/bin/gscl; do
    if [ -f "$linked" ] && readelf -d "$linked" | grep 'NEEDED.*OpenCL'; then
        exit 1
    fi
done

for file in mime/packages/gscl.xml misc/gscl.magic; do
    test -f "$prefix/share/$file"
done
cmp "$source/LICENSE" "$prefix/share/licenses/gscl/LICENSE"

# The loader of gdk-pixbuf and the media type, as update_caches.sh makes them known.
loader=$(find "$work" -name libpixbufloader-gscl.so)
if [ -n "$loader" ]; then
    test -f "$prefix/share/thumbnailers/gscl.thumbnailer"
    test "${loader#"$prefix"/}" != "$loader" # nothing lies outside the prefix
    query=$(pkg-config --variable=gdk_pixbuf_query_loaders gdk-pixbuf-2.0)
    system=$(pkg-config --variable=gdk_pixbuf_moduledir gdk-pixbuf-2.0)
    LD_LIBRARY_PATH=$libdir MESON_INSTALL_PREFIX=$prefix \
        sh "$source/host/desktop/update_caches.sh" "$query" "$(dirname "$loader")" "$system"
    grep -q image/x-gscl "$(dirname "$(dirname "$loader")")/loaders.cache"
    grep -q '^image/x-gscl:\*.gscl$' "$prefix/share/mime/globs"
    # The list that meson setup names where the loader has a folder of its own.
    named=$(sed -n 's/.*GDK_PIXBUF_MODULE_FILE=//p' "$build/meson-logs/meson-log.txt")
    [ "${loader#"$work"}" = "$system/${loader##*/}" ] || grep -q image/x-gscl "$work$named"
fi
if [ -f "$build/host/openimageio/gscl.imageio.so" ]; then
    test -f "$libdir/OpenImageIO/gscl.imageio.so"
fi

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
echo "CMake:"
cmake -S "$source/tests/install/cmake" -B "$work/cmake" -DCMAKE_PREFIX_PATH="$prefix" \
    -DEXAMPLE="$source/tests/example/encode_decode.c" >"$work/cmake.log" || { cat "$work/cmake.log"; exit 1; }
cmake --build "$work/cmake" >"$work/cmake.log" || { cat "$work/cmake.log"; exit 1; }
LD_LIBRARY_PATH=$libdir "$work/cmake/shared"
"$work/cmake/static"
echo "static:"
rm "$libdir"/libgscl.so* # so that -lgscl means libgscl.a
cc $flags $(pkg-config --cflags --libs --static gscl) -o "$work/static"
"$work/static"

if [ -x "$prefix/bin/gscl" ]; then
    echo "tool:"
    for file in man/man1/gscl.1 man/man1/gscl-encode.1 bash-completion/completions/gscl zsh/site-functions/_gscl \
        fish/vendor_completions.d/gscl.fish; do
        test -s "$prefix/share/$file"
    done
    DESTDIR=$work meson install -C "$build" --quiet # the shared library again
    "$prefix/bin/gscl" devices
fi
