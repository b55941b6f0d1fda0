#!/bin/sh
# Makes an installation known to the desktop: update_caches.sh QUERY_LOADERS MODULE_FOLDER SYSTEM_FOLDER
# Meson runs it after an installation that is not staged (without DESTDIR); packages run these commands by their own means.
set -eu
query_loaders=$1
module_folder=$2
system_folder=$3

if command -v update-mime-database >/dev/null; then
    update-mime-database "$MESON_INSTALL_PREFIX/share/mime"
fi
[ -x "$query_loaders" ] || exit 0
if [ "$module_folder" = "$system_folder" ]; then
    "$query_loaders" --update-cache
else
    # A folder of its own: its list has all loaders, and a program is told by GDK_PIXBUF_MODULE_FILE.
    set --
    for loader in "$system_folder"/*.so "$module_folder"/*.so; do
        [ ! -f "$loader" ] || set -- "$@" "$loader"
    done
    cache=$(dirname "$module_folder")/loaders.cache
    trap 'rm -f "$cache.new"' EXIT
    "$query_loaders" "$@" >"$cache.new" # a list that is cut off would hide loaders, so the old one stays until then
    mv "$cache.new" "$cache"
fi
