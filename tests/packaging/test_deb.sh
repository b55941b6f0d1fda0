#!/bin/sh
# Tests the packages of Debian that host/packaging/build.sh has built in a folder: test_deb.sh FOLDER
#
# Lintian has nothing to say but that no bug report asked for the package.  A system in a folder of its own, with nothing but the
# smallest Debian, installs them from a local repository and runs the tests of host/packaging/debian/tests, the thumbnailer and
# oiiotool.  Needs root, and a mirror of Debian.  Takes about five minutes.
set -eu
folder=$(cd "$1" && pwd)
cd "$(dirname "$0")/../.."
. tests/setup.sh
install_packages $packaging_packages
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT INT TERM

fail() {
    echo "test_deb: $*" >&2
    exit 1
}

if lintian --allow-root --fail-on none "$folder"/gscl_*.changes | grep -v ' initial-upload-closes-no-bugs ' | grep '^[EW]:'; then
    fail "lintian has more to say"
fi

system=$work/system
debootstrap --variant=minbase "$(. /etc/os-release && echo "$VERSION_CODENAME")" "$system" >"$work/log" 2>&1 || {
    tail "$work/log"
    fail "no system could be installed"
}
mkdir "$system/packages" "$system/source"
cp "$folder"/*.deb "$system/packages"
(cd "$system/packages" && apt-ftparchive packages . >Packages)
echo 'deb [trusted=yes] file:/packages ./' >"$system/etc/apt/sources.list.d/gscl.list"
dpkg-source --no-check -x "$folder"/gscl_*.dsc "$system/source/gscl" >/dev/null

# inside COMMAND...: runs it in the system, which has a /proc as long as it runs.
inside() {
    unshare --mount sh -c 'mount -t proc proc "$0/proc" && exec chroot "$0" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin \
        HOME=/root LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive "$@"' "$system" "$@"
}

# install PACKAGE...: with no other package than those that it needs.
install() {
    inside apt-get -q -y --no-install-recommends install "$@" >"$work/log" 2>&1 || {
        tail "$work/log"
        fail "cannot be installed: $*"
    }
}

# run_test NAME: a test of the source package.
run_test() {
    inside mkdir -p "/tmp/$1"
    inside env AUTOPKGTEST_TMP="/tmp/$1" sh "/source/gscl/debian/tests/$1" >"$work/log" 2>&1 || {
        cat "$work/log"
        fail "the test $1"
    }
    echo "ok $1"
}

inside apt-get -q update >"$work/log" 2>&1 || { cat "$work/log"; fail "no list of packages"; }
began=$(date +%s)
install gscl
run_test program
echo "the program from its repository, with an encode and a decode: $(($(date +%s) - began)) s"
if inside gscl decode /tmp/program/picture.gscl /tmp/picture.bmp 2>"$work/log"; then
    fail "a BMP file without OpenImageIO"
fi
grep -q 'needs the module gscl-imageio.so.*libOpenImageIO' "$work/log" || fail "no word of what is missing: $(cat "$work/log")"

install libgscl-dev gcc libc6-dev pkg-config
run_test library
install python3-gscl
run_test python
install gscl-gdk-pixbuf libgdk-pixbuf2.0-bin shared-mime-info
inside gdk-pixbuf-thumbnailer -s 32 /tmp/program/picture.gscl /tmp/thumbnail.png
inside test -s /tmp/thumbnail.png
grep -q '^image/x-gscl:\*.gscl$' "$system/usr/share/mime/globs"
install gscl-openimageio openimageio-tools
module=$(dirname "$(ls "$system"/usr/lib/*/OpenImageIO/gscl.imageio.so)")
inside env OIIO_LIBRARY_PATH="${module#"$system"}" oiiotool /tmp/program/picture.gscl -o /tmp/oiio.png
inside test -s /tmp/oiio.png
inside gscl decode /tmp/program/picture.gscl /tmp/picture.bmp # the program's module finds its libraries now
inside apt-get -q -y purge libgscl1 >"$work/log" 2>&1
left=$(cd "$system" && find usr etc var/lib -name '*gscl*' ! -path '*/apt/*')
[ -z "$left" ] || fail "left behind: $left"
echo "ok all packages"
