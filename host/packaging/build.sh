#!/bin/sh
# Builds a package of gscl from a clone: build.sh KIND FOLDER
#
# KIND: deb, npm, sdist, static, tarball, wheel, or wheel:TARGET with a target of host/python/build_wheel.sh.  Writes the package,
# and what makes the next build short, into FOLDER.  Packages that are missing (Debian) are installed.  README.md has a table.
set -eu
. "$(dirname "$0")/common.sh"
if [ $# != 2 ]; then
    sed -n '2,5s/^# \{0,1\}//p' "$0" >&2
    exit 2
fi
kind=$1
mkdir -p "$2"
folder=$(cd "$2" && pwd)

check_versions
case $kind in
deb | npm | sdist | static | tarball) sh "$here/$kind.sh" "$folder" ;;
wheel) sh "$here/wheel.sh" "$(uname -m)-manylinux" "$folder" ;;
wheel:*) sh "$here/wheel.sh" "${kind#wheel:}" "$folder" ;;
*)
    echo "build.sh: no package of this kind: $kind" >&2
    exit 2
    ;;
esac
