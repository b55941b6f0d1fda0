#!/bin/sh
# Each public header compiles alone, as C99 and as C++: check_headers.sh INCLUDE_FOLDER
set -eu
for header in "$1"/gscl/*.h; do
    for language in "c -std=c99" "c++ -std=c++11"; do
        printf '#include <gscl/%s>\nextern int used;\n' "$(basename "$header")" |
            gcc -x $language -Wall -Wextra -Werror -pedantic -I"$1" -fsyntax-only -
    done
done
