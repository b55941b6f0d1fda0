#!/bin/sh
# Each public header compiles alone, as C99 and as C++, and so does the example at the top of gscl.h:
# check_headers.sh INCLUDE_FOLDER
set -eu
include=$1
here=$(dirname "$0")
for header in "$include"/gscl/*.h; do
    for language in "c -std=c99" "c++ -std=c++11"; do
        printf '#include <gscl/%s>\nextern int used;\n' "$(basename "$header")" |
            gcc -x $language -Wall -Wextra -Werror -pedantic -I"$include" -fsyntax-only -
    done
done
sh "$here/header_example.sh" "$include/gscl/gscl.h" |
    gcc -x c -std=c99 -Wall -Wextra -Werror -pedantic -I"$include" -fsyntax-only -
