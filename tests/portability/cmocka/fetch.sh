#!/bin/sh
# Fetches the source package of cmocka, for machines for which this one has no package of it: fetch.sh FOLDER
#
# apt checks it.  Its lists of sources are kept out of those of the system, which may have none.
set -eu
target=$1
here=$(cd "$(dirname "$0")" && pwd)
[ ! -f "$target/meson.build" ] || exit 0
part=$target.part
rm -rf "$part" "$target"
mkdir -p "$part/lists/partial" "$part/archives/partial"
cd "$part"
keys=/usr/share/keyrings/debian-archive-keyring.gpg
[ ! -f "$keys" ] || option="[signed-by=$keys] "
apt-cache madison libcmocka-dev |
    sed -n "1s|.* \([^ ]*\) \([^/ ]*\)/\([^ ]*\) .*|deb-src ${option:-}\1 \2 \3|p" >sources.list
for command in update "source --download-only cmocka"; do
    apt-get -q -o Dir::Etc::SourceList="$PWD/sources.list" -o Dir::Etc::SourceParts=/dev/null \
        -o Dir::State::Lists="$PWD/lists" -o Dir::Cache="$PWD" -o APT::Sandbox::User= $command
done
tar xf cmocka_*.orig.tar.xz
cp "$here/meson.build" cmocka-*/
mv cmocka-*/ "$target"
rm -rf "$part"
