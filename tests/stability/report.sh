#!/bin/sh
# Measures all cases and writes the tables of STABILITY.md: sh tests/stability/report.sh [BUILD]
set -eu
cd "$(dirname "$0")/../.."
build=${1:-build}
document=tests/stability/STABILITY.md
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
[ -f "$build/build.ninja" ] || meson setup "$build" -Dtool=enabled -Dtests=enabled
ninja -C "$build"
rm -f "$work/rows"
STABILITY_REPORT=$work/rows meson test -C "$build" --no-rebuild --suite stability --num-processes 1

# The table of agreement.c: a row for each case and blend, with both mappings, forward and backward.
scenes() {
    echo "| case | blend | forward: bound | cpu | gpu | backward: bound | cpu | gpu | share of its bound |"
    echo "|---|---|---|---|---|---|---|---|---|"
    awk -F'|' '$1 == "scene" {
        split($3, detail, ", ")
        key = $2 "|" detail[1]
        if (!(key in seen)) { seen[key] = 1; order[++count] = key }
        bound[key, $4] = $5
        measured[key, $4, detail[2]] = $6
        if ($4 == "share" && $6 > share[key]) share[key] = $6
    }
    END {
        for (i = 1; i <= count; i++) {
            key = order[i]
            split(key, name, "|")
            printf "| %s | %s |", name[1], name[2]
            for (j = 1; j <= 2; j++) {
                quantity = j == 1 ? "forward" : "backward"
                printf " %s | %s | %s |", bound[key, quantity], measured[key, quantity, "cpu"], measured[key, quantity, "gpu"]
            }
            printf " %.0f %% |\n", 100 * share[key]
        }
    }' "$work/rows"
}

other_subjects() {
    echo "| subject | case | | quantity | bound | measured |"
    echo "|---|---|---|---|---|---|"
    awk -F'|' '$1 != "scene" { printf "| %s | %s | %s | %s | %s | %s |\n", $1, $2, $3, $4, $5, $6 }' "$work/rows"
}

{
    sed '/^<!-- tables -->$/q' "$document"
    echo "$(date -u +%F), $(sed -n 's/^model name.*: //p' /proc/cpuinfo | head -n 1); $("$build/gscl" devices | sed -n "1s/^[* ]*[0-9.]* *//p");" \
        "\`sh tests/stability/report.sh\`."
    echo
    echo "### Scenes"
    echo
    scenes
    echo
    echo "### Other subjects"
    echo
    other_subjects
    sed -n '/^<!-- \/tables -->$/,$p' "$document"
} >"$work/page"
cp "$work/page" "$document"
