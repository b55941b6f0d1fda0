# For the scripts beside this file, which read it with `.`: its folder, the root of the sources, the lists of Debian packages, the
# version, and the files that repeat it.
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
. "$root/tests/setup.sh"
version=$(sed -n 's/^#define GSCL_VERSION "\(.*\)"/\1/p' "$root/host/include/gscl/version.h")
api_major=${version%%.*}

# expect_line FILE LINE: a file that repeats the version has this line.
expect_line() {
    grep -qxF -- "$2" "$root/$1" || {
        echo "$1 does not say the version $version of host/include/gscl/version.h; expected: $2" >&2
        return 1
    }
}

check_versions() {
    head -n 1 "$root/host/packaging/debian/changelog" | grep -q "^gscl ($version-[0-9]*) " || {
        echo "host/packaging/debian/changelog does not begin with version $version" >&2
        return 1
    }
    expect_line host/packaging/debian/control "Package: libgscl$api_major" &&
        expect_line host/packaging/debian/libgscl$api_major.symbols "libgscl.so.$api_major libgscl$api_major #MINVER#" &&
        expect_line host/libgscl.map "GSCL_$api_major {" &&
        expect_line host/web/package.json "  \"version\": \"$version\","
}
