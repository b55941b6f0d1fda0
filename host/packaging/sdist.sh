#!/bin/sh
# Writes the source distribution of the Python package, of the last commit: sdist.sh FOLDER; FOLDER/gscl-VERSION.tar.gz
#
# It is host/python, with the sources of the library in the place of the link subprojects/gscl.
set -eu
. "$(dirname "$0")/common.sh"
folder=$1
install_packages $tarball_packages python3-dev python3-venv

[ -x "$folder/venv/bin/pip" ] || python3 -m venv "$folder/venv"
PIP_CONSTRAINT="$root/tests/python/requirements.txt" \
    "$folder/venv/bin/pip" --disable-pip-version-check --quiet install cffi meson meson-python ninja
export PATH="$folder/venv/bin:$PATH"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT INT TERM
cd "$root"
git archive HEAD:host/python | tar -x -C "$work"
rm "$work/subprojects/gscl"
mkdir "$work/subprojects/gscl"
git archive HEAD LICENSE cl format host meson.build meson_options.txt ':!host/packaging' ':!host/python' |
    tar -x -C "$work/subprojects/gscl"

# meson takes files of a commit; its date is that of the files.
date=$(git log -1 --format=%cI)
cd "$work"
export GIT_AUTHOR_DATE="$date" GIT_COMMITTER_DATE="$date" GIT_CONFIG_GLOBAL=/dev/null GIT_CONFIG_SYSTEM=/dev/null
{
    git init -q
    git add --all --force
    git -c user.name=gscl -c user.email=gscl commit -q -m sources
    python3 -c 'import sys, mesonpy; mesonpy.build_sdist(sys.argv[1])' "$folder"
} >"$folder/sdist.log" 2>&1 || { tail -n 20 "$folder/sdist.log" >&2; exit 1; }
ls "$folder"/gscl-*.tar.gz
