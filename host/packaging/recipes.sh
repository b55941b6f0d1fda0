#!/bin/sh
# Writes the recipes of Homebrew, conda, Nix and vcpkg for a release: recipes.sh HOMEPAGE URL TARBALL FOLDER
#
# TARBALL is what tarball.sh has written, and what URL will bring; its checksums come into the recipes.
set -eu
. "$(dirname "$0")/common.sh"
[ $# = 4 ] || { sed -n '2,4s/^# \{0,1\}//p' "$0" >&2; exit 2; }
sha256=$(sha256sum <"$3")
sha512=$(sha512sum <"$3")
mkdir -p "$4"
folder=$(cd "$4" && pwd)
cd "$here/recipes"
for file in gscl.rb package.nix recipe.yaml vcpkg/portfile.cmake vcpkg/vcpkg.json; do
    mkdir -p "$(dirname "$folder/$file")"
    sed -e "s|@HOMEPAGE@|$1|; s|@URL@|$2|; s|@VERSION@|$version|; s|@SHA256@|${sha256%% *}|; s|@SHA512@|${sha512%% *}|" "$file" >"$folder/$file"
done
