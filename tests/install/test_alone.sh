#!/bin/sh
# A build with -Dtool=disabled makes and installs the library alone: test_alone.sh BUILD
set -eu
build=$1

# list WHAT EXPRESSION: a line for each of what meson knows of the build
list() {
    meson introspect "--$1" "$build" | python3 -c "import json, sys; known = json.load(sys.stdin); print(*($2), sep='\n')"
}
if others=$(list targets "it['name'] for it in known if it['type'] != 'custom'" | grep -vx -e gscl -e gscl-small); then
    echo "built beside the library:" $others
    exit 1
fi
if others=$(list installed "known.values()" | grep -v -e '/libgscl\.[^/]*$' -e '/include/gscl/[a-z]*\.h$' -e '/pkgconfig/gscl\.pc$' \
    -e '/cmake/gscl/' -e '/mime/packages/gscl\.xml$' -e '/misc/gscl\.magic$' -e '/licenses/gscl/LICENSE$'); then
    echo "installed beside the library:" $others
    exit 1
fi
