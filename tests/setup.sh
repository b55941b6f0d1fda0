# For tests/quickstart.sh and tests/run.sh, which read this file with `.`: Debian packages.

# Packages of the library and the tool: clang compiles the kernels into the library, and PoCL is an OpenCL device on processors
# that the library has no kernels for.
build_packages="meson ninja-build pkg-config gcc g++ clang libc6-dev python3 opencl-headers ocl-icd-libopencl1
    pocl-opencl-icd libpng-dev libjpeg-dev liblcms2-dev libopenimageio-dev libopenjp2-7-dev libcairo2-dev"
# Packages of the package for web pages: those of the decoder, and those of the encoder, which needs a newer compiler than Debian 12's
# first one.
web_packages="binaryen esbuild lld"
web_encoder_packages="clang-16 lld-16 libclang-rt-16-dev-wasm32 wasi-libc"
# Further packages of the tests.
test_packages="abigail-tools clang-format clang-tidy file libcmocka-dev libglib2.0-bin mesa-opencl-icd oclgrind shared-mime-info valgrind
    openimageio-tools python3-dev python3-venv $web_packages $web_encoder_packages chromium firefox-esr nodejs
    dbus-daemon doxygen imagemagick jq libgdk-pixbuf-2.0-dev libgdk-pixbuf2.0-bin tumbler
    cmake fish man-db mandoc librsvg2-bin zsh"

# Packages of tests/targets: a compiler of GPUs and their built-in functions.
target_packages="clang-16 libclc-15 lld"

# Packages of tests/portability: machine_packages MACHINE.  Beside gcc-multilib Debian has no cross compilers.
machine_packages() {
    case $1 in
    aarch64) echo gcc-aarch64-linux-gnu libc6-dev-arm64-cross qemu-user ;;
    armhf) echo gcc-arm-linux-gnueabihf libc6-dev-armhf-cross qemu-user ;;
    clang-i386) echo gcc-i686-linux-gnu libc6-dev-i386-cross qemu-user ;;
    i386) echo gcc-i686-linux-gnu libc6-dev-i386-cross qemu-user ;;
    mingw) echo gcc-mingw-w64-x86-64 wine64 ;;
    musl) echo musl-tools ;;
    ppc64) echo gcc-powerpc64-linux-gnu libc6-dev-ppc64-cross qemu-user ;;
    riscv64) echo gcc-riscv64-linux-gnu libc6-dev-riscv64-cross qemu-user ;;
    s390x) echo gcc-s390x-linux-gnu libc6-dev-s390x-cross qemu-user ;;
    x87) echo gcc ;;
    esac
}
# Package that unpacks the sources of libraries for other machines (tests/portability/image_libraries.sh).
source_packages="dpkg-dev"
# Machines that tests/run.sh tests.
quick_machines="i386 s390x aarch64 mingw"
# Packages of tests/portability/microcontroller.
microcontroller_packages="gcc-arm-none-eabi libnewlib-arm-none-eabi qemu-system-arm"

# Packages of host/packaging: what builds a source tarball, Debian packages, the package of npm, the static program and wheels.
tarball_packages="meson ninja-build gcc libc6-dev git python3 xz-utils"
deb_packages="$tarball_packages build-essential clang debhelper dh-python dpkg-dev fakeroot g++ libcairo2-dev
    libgdk-pixbuf-2.0-dev libjpeg-dev liblcms2-dev libopenimageio-dev libopenjp2-7-dev libpng-dev opencl-headers pkg-config
    python3-cffi python3-dev zlib1g-dev"
npm_packages="gcc libc6-dev meson ninja-build python3 $web_packages $web_encoder_packages"
static_packages="clang gcc meson ninja-build pkg-config python3 $source_packages"
wheel_packages="clang opencl-headers python3 python3-dev python3-venv"
windows_wheel_packages="gcc-mingw-w64-x86-64 $source_packages"
# Those that tests/packaging needs besides.
packaging_packages="apt-utils debootstrap lintian"

missing_packages() {
    for package in "$@"; do
        case $(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null) in
        installed) ;;
        *) printf '%s ' "$package" ;;
        esac
    done
}

# Installs missing packages, without questions.  In a shell of its own, so that no variable of the script that calls it changes.
install_packages() (
    if ! command -v dpkg-query >/dev/null; then
        echo "setup: not a Debian system: install packages like these yourself:" $* >&2
        return 0
    fi
    missing=$(missing_packages "$@")
    [ -n "$missing" ] || return 0
    root=
    if [ "$(id -u)" != 0 ]; then
        root=sudo
        if ! command -v sudo >/dev/null; then
            echo "setup: neither root nor sudo: as root, run: apt-get install $missing" >&2
            return 1
        fi
    fi
    echo "setup: installing $missing"
    log=$(mktemp)
    if $root apt-get -q update >"$log" 2>&1 &&
        $root env DEBIAN_FRONTEND=noninteractive apt-get -q -y --no-install-recommends --no-remove install $missing >>"$log" 2>&1; then
        rm -f "$log"
        return 0
    fi
    tail -n 5 "$log" >&2
    rm -f "$log"
    echo "setup: apt-get could not install: $missing" >&2
    return 1
)
