#!/bin/sh
# Builds all fuzz targets as OSS-Fuzz does: its build.sh is the line `sh tests/fuzz/oss_fuzz_build.sh`.
#
# Of the environment: CC, CXX, CFLAGS, CXXFLAGS and LIB_FUZZING_ENGINE, the compilers with their sanitizers and what has main; OUT, which
# gets fuzz_TARGET, fuzz_TARGET_seed_corpus.zip, fuzz_TARGET.options and, for some, fuzz_TARGET.dict; WORK, for objects (default: a
# folder that is removed).  Words name the targets to build; default: all.  Libraries that images need are copied to OUT/lib.
#
# Needs meson, ninja, pkg-config, python3, and libpng, libjpeg and LittleCMS with their headers.  Without OSS-Fuzz:
#
#     env CC=clang CXX=clang++ CFLAGS="-O1 -g -fsanitize=address,undefined,fuzzer-no-link" LIB_FUZZING_ENGINE=-fsanitize=fuzzer \
#         CXXFLAGS="-g -fsanitize=address,undefined" OUT=/tmp/out sh tests/fuzz/oss_fuzz_build.sh
set -eu
cd "$(dirname "$0")/../.."
work=${WORK-}
if [ -z "$work" ]; then
    work=$(mktemp -d)
    trap 'rm -rf "$work"' EXIT INT TERM
fi
library=$work/library/libgscl.a
mkdir -p "$OUT"

# The library that decodes, which all targets that link one need, with the compiler and the flags of the environment.  Comparisons are not
# traced in it, as in the sources of the format.
build_library() {
    [ -f "$work/library/build.ninja" ] || CFLAGS="$CFLAGS -fno-sanitize-coverage=trace-cmp" meson setup "$work/library" -Dbuildtype=plain -Db_lundef=false -Db_pie=false -Dopencl=disabled \
        -Dnative=disabled -Dtool=disabled -Dtests=disabled -Dweb=disabled >/dev/null
    ninja -C "$work/library" libgscl.a >/dev/null
}

compile() {
    objects=
    mkdir -p "$work/$target"
    for source in tests/fuzz/fuzz_$target.c $sources; do
        object=$work/$target/$(echo "$source" | tr / _).o
        $CC $CFLAGS $traced -std=c99 -DFUZZ_SAMPLE $includes $more -Wno-unused-command-line-argument -c "$source" -o "$object"
        objects="$objects $object"
    done
    $CXX $CXXFLAGS $objects $LIB_FUZZING_ENGINE $more -Wl,-rpath,'$ORIGIN/lib' -o "$OUT/fuzz_$target"
}

# Shared libraries that the machine which fuzzes may lack.
copy_libraries() {
    for file in $(ldd "$OUT/fuzz_$target" | awk '/lib(png|jpeg|lcms2|z)[^ ]*\.so/ { print $3 }'); do
        mkdir -p "$OUT/lib"
        [ -f "$OUT/lib/${file##*/}" ] || cp -L "$file" "$OUT/lib"
    done
}

# The words that a target knows: long options of all commands, or a list beside this script.
write_dictionary() {
    case $target in
    options) sed -n 's/.*\.name = "\([a-z0-9-]*\)".*/"--\1"/p' host/tool/commands/*.c | sort -u >"$OUT/fuzz_$target.dict" ;;
    *) [ ! -f "tests/fuzz/$target.dict" ] || cp "tests/fuzz/$target.dict" "$OUT/fuzz_$target.dict" ;;
    esac
}

write_options() {
    {
        echo "[libfuzzer]"
        for option in $options; do
            echo "${option#-}" | sed 's/=/ = /'
        done
        [ ! -f "$OUT/fuzz_$target.dict" ] || echo "dict = fuzz_$target.dict"
    } >"$OUT/fuzz_$target.options"
}

write_corpus() {
    rm -f "$OUT/fuzz_${target}_seed_corpus.zip"
    python3 - "$OUT/fuzz_${target}_seed_corpus.zip" $kept <<'PYTHON'
import hashlib, pathlib, sys, zipfile

seeds = {hashlib.sha1(data).hexdigest(): data for folder in sys.argv[2:] for path in sorted(pathlib.Path(folder).iterdir())
         if path.is_file() for data in [path.read_bytes()]}
with zipfile.ZipFile(sys.argv[1], "w", zipfile.ZIP_DEFLATED) as archive:
    for name, data in sorted(seeds.items()):
        archive.writestr(zipfile.ZipInfo(name), data)
PYTHON
}

. tests/fuzz/targets.sh
for name in ${*:-$targets}; do
    set_target "$name"
    case $more in
    *"$library"*) build_library ;;
    esac
    compile
    copy_libraries
    write_dictionary
    write_options
    write_corpus
    echo "$target: $OUT/fuzz_$target"
done
