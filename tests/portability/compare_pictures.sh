#!/bin/sh
# Encodes pictures on another machine and on this one, and prints what PSNR the files have: compare_pictures.sh MACHINE FOLDER
#
# run.sh has built the tool of MACHINE, and that of musl, which stands for this machine.  FOLDER has PNG and JPEG files.  Each is
# encoded for 0.1 bits per pixel on the device "host".  Ends with status 1 where MACHINE is worse by more than 0.05 dB in the mean.
set -u
here=$(cd "$(dirname "$0")" && pwd)
machine=$1
folder=$2
allowed=0.05 # dB
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# psnr MACHINE PICTURE
psnr() {
    program=$(ls "$here/../../build-portability/$1/gscl" "$here/../../build-portability/$1/gscl.exe" 2>/dev/null)
    tool="sh $here/on_machine.sh $1 $program"
    $tool encode --quiet --device host --bpp 0.1 "$2" -o "$work/picture.gscl" &&
        $tool decode "$work/picture.gscl" -o "$work/picture.png" && $tool compare "$2" "$work/picture.png" |
        awk '/^PSNR/ { print $2 }'
}

for picture in "$folder"/*.png "$folder"/*.jpg; do
    [ ! -f "$picture" ] || echo "$(basename "$picture") $(psnr musl "$picture") $(psnr "$machine" "$picture")"
done | awk -v machine="$machine" -v allowed=$allowed '
    { printf "%-20s x86-64 %s dB, %s %s dB (%+.3f dB)\n", $1, $2, machine, $3, $3 - $2; sum += $3 - $2; count++; whole += NF == 3 }
    END {
        if (!count || whole < count)
            exit 1
        printf "mean difference of %d pictures: %+.3f dB\n", count, sum / count
        exit sum / count < -allowed
    }'
