#!/bin/sh
# Tests the recipes of host/packaging/recipes as far as tools are at hand: test_recipes.sh [--whole] TARBALL [PYTHON]
#
# They are filled in for TARBALL, and parsed: by Ruby and Nix where these are installed, by rattler-build (py-rattler-build) where
# PYTHON has it, and by CMake, for which this file has the functions of vcpkg that the port calls.  With --whole those of conda,
# Homebrew and Nix are built and tested, with this machine's tools and libraries in the place of those of their systems, in about
# six minutes of processor time.
set -eu
whole=
[ "$1" != --whole ] || { whole=yes; shift; }
here=$(cd "$(dirname "$0")" && pwd)
tarball=$(realpath "$1")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT INT TERM

sh "$here/../../host/packaging/recipes.sh" https://gscl.example "file://$tarball" "$tarball" "$work"
if grep -rn '@[A-Z0-9]*@' "$work"; then
    echo "the recipes are not filled in" >&2
    exit 1
fi
if command -v ruby >/dev/null; then
    ruby -c "$work/gscl.rb"
fi
if command -v nix-instantiate >/dev/null; then
    nix-instantiate --parse "$work/package.nix" >/dev/null 2>&1
fi
python3 -m json.tool "$work/vcpkg/vcpkg.json" /dev/null
if "${2:-python3}" -c 'import rattler_build' 2>/dev/null; then
    "${2:-python3}" - "$work/recipe.yaml" <<'END'
import sys

import rattler_build

with open(sys.argv[1], encoding="utf-8") as file:
    recipe = rattler_build.Stage0Recipe.from_yaml(file.read())
compilers = "c_compiler: [gcc]\ncxx_compiler: [gxx]\nc_stdlib: [sysroot]\nc_stdlib_version: ['2.28']\n"
platform = rattler_build.PlatformConfig(target_platform="linux-64")
(variant,) = recipe.render(rattler_build.VariantConfig.from_yaml(compilers), rattler_build.RenderConfig(platform=platform))
assert variant.recipe.package.name == "gscl"
END
fi

cat >"$work/port.cmake" <<'END'
set(VERSION 1)
function(vcpkg_download_distfile name)
    cmake_parse_arguments(it "" "FILENAME;SHA512" "URLS" ${ARGN})
    string(LENGTH "${it_SHA512}" length)
    if(it_UNPARSED_ARGUMENTS OR NOT length EQUAL 128)
        message(FATAL_ERROR "arguments: ${ARGN}")
    endif()
endfunction()
foreach(name extract_source_archive configure_meson install_meson fixup_pkgconfig cmake_config_fixup install_copyright)
    function(vcpkg_${name})
    endfunction()
endforeach()
include("${CMAKE_CURRENT_LIST_DIR}/vcpkg/portfile.cmake")
END
cmake -DCURRENT_PACKAGES_DIR="$work/nothing" -P "$work/port.cmake"
[ -n "$whole" ] || exit 0

. "$here/../setup.sh"
install_packages $deb_packages

# use PROGRAM
use() {
    "$1" encode "$here/../sample/readme.png" -o "$work/readme.gscl" --bytes 2000 --effort 2
    "$1" decode "$work/readme.gscl" -o "$work/readme.png"
}

if command -v ruby >/dev/null; then
    mkdir "$work/sources"
    tar -xf "$tarball" -C "$work/sources" --strip-components 1
    version=$(basename "$tarball" .tar.xz)
    (cd "$work/sources" && ruby "$here/build_formula.rb" "$work/gscl.rb" "${version#gscl-}" "$work/homebrew")
    LD_LIBRARY_PATH="$work/homebrew/lib" use "$work/homebrew/bin/gscl"
    echo "built: Homebrew's formula"
fi
if command -v nix-build >/dev/null; then
    nix=$work/nix
    XDG_CACHE_HOME="$nix/cache" NIX_STORE_DIR="$nix/store" NIX_STATE_DIR="$nix/state" NIX_LOG_DIR="$nix/log" NIX_CONF_DIR="$nix/conf" \
        nix-build --option sandbox false --option build-users-group '' --option substitute false --out-link "$work/from_nix" \
        --arg recipe "$work/package.nix" "$here/nixpkgs.nix"
    use "$work/from_nix/bin/gscl"
    echo "built: Nix's expression"
    chmod -R u+w "$nix/store"
fi
if "${2:-python3}" -c 'import rattler_build' 2>/dev/null; then
    mkdir "$work/conda"
    "${2:-python3}" "$here/build_conda.py" "$work/recipe.yaml" "$work/conda"
    echo "built: conda's recipe"
fi
