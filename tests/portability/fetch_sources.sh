#!/bin/sh
# Fetches source packages of Debian, with its patches, as FOLDER/PACKAGE: fetch_sources.sh FOLDER PACKAGE...
#
# apt checks them.  Its lists of sources are kept out of those of the system, which may have none.
set -eu
target=$1
shift
[ ! -d "$target" ] || exit 0
part=$target.part
rm -rf "$part"
mkdir -p "$part/lists/partial" "$part/archives/partial"
cd "$part"
keys=/usr/share/keyrings/debian-archive-keyring.gpg
[ ! -f "$keys" ] || option="[signed-by=$keys] "
apt-cache madison libcmocka-dev |
    sed -n "1s|.* \([^ ]*\) \([^/ ]*\)/\([^ ]*\) .*|deb-src ${option:-}\1 \2 \3|p" >sources.list
for command in update "source $*"; do
    apt-get -q -o Dir::Etc::SourceList="$PWD/sources.list" -o Dir::Etc::SourceParts=/dev/null \
        -o Dir::State::Lists="$PWD/lists" -o Dir::Cache="$PWD" -o APT::Sandbox::User= $command
done
mkdir sources
for package in "$@"; do
    mv "$package"-*/ "sources/$package"
done
mv sources "$target"
rm -rf "$part"
