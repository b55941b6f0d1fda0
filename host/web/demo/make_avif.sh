#!/bin/sh
# Puts @jsquash/avif of npm as a worker beside the demonstration page: make_avif.sh BUILD_FOLDER
set -eu

build=$1
to=$build/host/web/demo
packages=$build/avif
npm install --prefix "$packages" --silent --no-fund --no-audit @jsquash/avif@2
cp "$(dirname "$0")/avif.js" "$packages/avif.js"
esbuild --bundle --minify --format=esm --target=es2022 --log-level=error "$packages/avif.js" --outfile="$packages/worker.js"
cp "$packages/node_modules/@jsquash/avif/codec/enc/avif_enc.wasm" "$to"
mv "$packages/worker.js" "$to/avif.js" # last, because the page has AVIF where this is there
