#!/bin/sh
# Shows the demonstration page of the package for web pages: sh host/web/serve.sh [PORT]
#
# Installs missing packages (Debian), builds in build/, encodes sample pictures into build/host/web/demo/samples, fetches
# an encoder of AVIF where there is npm, and serves the page until it is stopped.  PORT: default 8000.
set -eu

port=${1:-8000}
cd "$(dirname "$0")/../.."
. tests/setup.sh
install_packages $build_packages $web_packages $web_encoder_packages

echo "serve: building"
log=$(mktemp)
{
    if [ -f build/build.ninja ]; then meson setup --reconfigure build -Dweb=enabled; else meson setup build -Dweb=enabled; fi
    ninja -C build gscl gscl-imageio.so tests/sample/make_sample web-page
} >"$log" 2>&1 || { tail -n 30 "$log" >&2; exit 1; }
rm -f "$log"
if command -v npm >/dev/null && [ ! -f build/host/web/demo/avif.js ]; then
    sh host/web/demo/make_avif.sh build || echo "serve: no AVIF beside the photograph: npm could not install @jsquash/avif" >&2
fi
[ -f build/host/web/demo/samples/samples.json ] || sh host/web/demo/make_samples.sh build

echo "serve: open http://localhost:$port/demo/ in a browser; Ctrl-C ends"
exec python3 -m http.server --bind 127.0.0.1 --directory build/host/web "$port" 2>/dev/null
