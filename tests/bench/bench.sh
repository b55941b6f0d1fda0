#!/bin/sh
# Runs a benchmark script in a Python environment with the packages of requirements.txt:
#     sh tests/bench/bench.sh compare_codecs FOLDER [OPTIONS]
set -eu
here=$(dirname "$0")
. "$here/../setup.sh"
script=$1
shift
environment=${BENCH_ENVIRONMENT:-build/bench-python}
if [ ! -x "$environment/bin/python" ]; then
    install_packages python3-venv
    python3 -m venv "$environment"
fi
"$environment/bin/python" -m pip install --quiet --disable-pip-version-check -r "$here/requirements.txt"
if [ "$script" = perceptual ]; then # Butteraugli and DSSIM
    install_packages libjxl-devtools
    if [ ! -x "$environment/bin/dssim" ]; then
        command -v cargo >/dev/null || install_packages cargo-web rustc-web # those of Debian that follow Rust's releases
        cargo install --quiet --locked --root "$environment" --version 3.5.1 dssim
    fi
fi
PATH=$(cd "$environment" && pwd)/bin:$PATH
export PATH
exec "$environment/bin/python" "$here/$script.py" "$@"
