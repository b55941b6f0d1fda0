#!/bin/sh
# Builds packages of the last commit in a folder, and tests them: run.sh [--whole] FOLDER [WEB]
#
# WEB: host/web of a build folder, for the package of npm (default: it is built).  Without --whole the source packages are written
# and looked at, and the package of npm and the recipes are checked, in half a minute.  With it all packages are built, installed
# and used, in about half an hour of processor time; for the Debian packages it needs root.  Prints a line for each.
set -u
whole=
[ "${1:-}" != --whole ] || { whole=yes; shift; }
here=$(cd "$(dirname "$0")" && pwd)
mkdir -p "$1"
folder=$(cd "$1" && pwd)
web=${2:-}
failed=0

# check NAME COMMAND...
check() {
    name=$1
    shift
    began=$(date +%s)
    if "$@" >"$folder/log" 2>&1; then
        echo "ok      $name ($(($(date +%s) - began)) s)"
        grep -E '^(from nothing|auditwheel|built|left out|the program from its repository)' "$folder/log" | sed 's/^/        /'
    else
        echo "FAILED  $name ($(($(date +%s) - began)) s)"
        tail -n 20 "$folder/log" | sed 's/^/        /'
        failed=1
    fi
}

# build KIND [FOLDER]
build() {
    check "build $1" sh "$here/../../host/packaging/build.sh" "$1" "$folder/${2:-$1}"
}

quick=--quick
[ -z "$whole" ] || quick=
build tarball
check tarball sh "$here/test_tarball.sh" $quick "$folder/tarball"
build sdist
check sdist sh "$here/test_sdist.sh" $quick "$folder/sdist"
# What reads the recipe of conda is large.
[ -z "$whole" ] || "$folder/sdist/venv/bin/pip" --disable-pip-version-check --quiet install py-rattler-build
check recipes sh "$here/test_recipes.sh" ${whole:+--whole} "$folder"/tarball/gscl-*.tar.xz "$folder/sdist/venv/bin/python"
if ! command -v npm >/dev/null; then
    echo "left out  npm, which is not installed"
elif [ -n "$web" ]; then
    check npm sh "$here/test_npm.sh" --quick "$web" "$folder/publint"
fi
[ -n "$whole" ] || exit "$failed"

if command -v npm >/dev/null; then
    build npm
    check npm sh "$here/test_npm.sh" "$folder"/npm/gscl-*.tgz "$folder/publint"
fi
build static
check static sh "$here/test_static.sh" "$folder/static"
build wheel
for target in aarch64-manylinux x86_64-musllinux aarch64-musllinux x86_64-windows; do
    build "wheel:$target" wheel
done
check wheels sh "$here/test_wheels.sh" "$folder/wheel"
build deb
check deb sh "$here/test_deb.sh" "$folder/deb"
exit "$failed"
