#!/bin/sh
# Encodes the project's sample image for the demonstration page: make_samples.sh BUILD_FOLDER
set -eu

build=$1
to=$build/host/web/demo/samples
mkdir -p "$to"
"$build/tests/sample/make_sample" "$to/harbour.png"

# encode NAME OPTIONS...
encode() {
    name=$1
    shift
    echo "serve: encoding $name"
    "$build/gscl" encode "$to/harbour.png" -o "$to/$name" --quiet "$@"
}
encode harbour.gscl --bytes 9000
encode progressive.gscl --bytes 9000 --progressive
encode 24kB.gscl --bytes 24000 --effort 2
encode 1000.gscl --bytes 1000
encode 200.gscl --bytes 200
rm "$to/harbour.png"

cat >"$to/samples.json" <<'END'
[
{"file": "harbour.gscl", "title": "Harbour, 9 kB"},
{"file": "progressive.gscl", "title": "Progressive, 9 kB"},
{"file": "24kB.gscl", "title": "Fine, 24 kB"},
{"file": "1000.gscl", "title": "A preview, 1000 bytes"},
{"file": "200.gscl", "title": "A placeholder, 200 bytes"}
]
END
