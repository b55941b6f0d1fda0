#!/bin/sh
# Makes the site, a folder of static pages: sh host/site/build.sh OUT [BUILD]
#
# OUT: a folder that is emptied.  BUILD: the build folder of the program, which is built where it is missing; default: build.  The
# pages are the documents and tutorials of the source tree, the manual pages, and the references: of C by Doxygen, whose warnings are errors, of
# Python by pdoc and of the package for web pages by TypeDoc.  All links inside the site are checked at the end.
#
# Installs doxygen and mandoc (Debian), and packages of PyPI and npm in folders of BUILD.  SITE_PYTHON names a Python that has gscl and the
# packages of requirements.txt already.  SITE_PARTS names the references to make; default: "c python web".  TypeDoc needs npm
# and Node 20.
set -eu
cd "$(dirname "$0")/../.."
. tests/setup.sh
out=$1
build=${2:-build}
parts=${SITE_PARTS-c python web}
here=host/site

rm -rf "$out"
mkdir -p "$out"

install_packages doxygen mandoc
if [ ! -x "$build/gscl" ]; then
    [ -f "$build/build.ninja" ] || meson setup "$build" >/dev/null
    ninja -C "$build" gscl >/dev/null
fi

# python: one with the package gscl, whose reference pdoc makes from what it imports.
python=${SITE_PYTHON-}
if [ -z "$python" ]; then
    [ -x "$build/site/python/bin/pip" ] || python3 -m venv "$build/site/python"
    python=$build/site/python/bin/python
    pip="$python -m pip --disable-pip-version-check --quiet"
    $pip install -r "$here/requirements.txt"
    case " $parts " in
    *" python "*) $pip install -Csetup-args=-Dgscl:native=disabled "host/python[batch]" ;;
    esac
fi

for part in $parts; do
    case $part in
    c)
        { cat "$here/Doxyfile"; echo "OUTPUT_DIRECTORY = $out"; } | doxygen -
        ;;
    python)
        "$python" -m pdoc --no-show-source -o "$out/python" gscl gscl.batch '!gscl.GsclImagePlugin'
        ;;
    web)
        mkdir -p "$build/site/web"
        cp "$here/package.json" "$here/typedoc.json" "$here/tsconfig.json" host/web/*.d.ts host/web/encoder/*.d.ts host/web/gpu/*.d.ts "$build/site/web"
        (cd "$build/site/web" && npm install --no-audit --no-fund --ignore-scripts --silent && npx typedoc --out reference)
        rm -rf "$out/web"
        mv "$build/site/web/reference" "$out/web"
        ;;
    *)
        echo "build.sh: no part '$part'; there are c, python and web" >&2
        exit 2
        ;;
    esac
done

"$python" "$here/build.py" "$out" --gscl "$build/gscl"
"$python" "$here/check_links.py" "$out"
