# The formula of Homebrew.
class Gscl < Formula
  desc "Image codec that stores a picture as 2D Gaussians"
  homepage "@HOMEPAGE@"
  url "@URL@"
  sha256 "@SHA256@"
  license "BSD-2-Clause"

  depends_on "meson" => :build
  depends_on "ninja" => :build
  depends_on "opencl-headers" => :build
  depends_on "pkgconf" => :build
  depends_on "cairo"
  depends_on "jpeg-turbo"
  depends_on "libpng"
  depends_on "little-cms2"
  depends_on "openimageio"
  depends_on "openjpeg"

  uses_from_macos "zlib"

  on_linux do
    depends_on "llvm" => :build # compiles the kernels of the processor
  end

  def install
    system "meson", "setup", "build", "-Dtool=enabled", "-Dtests=disabled", "-Dweb=disabled", "-Ddesktop=disabled",
           *std_meson_args
    system "meson", "compile", "-C", "build", "--verbose"
    system "meson", "install", "-C", "build"
  end

  test do
    assert_match version.to_s, shell_output("#{bin}/gscl --version")
    (testpath/"test.c").write <<~C
      #include <gscl/gscl.h>
      int main(void) { return gscl_version_number() != GSCL_VERSION_NUMBER; }
    C
    system ENV.cc, "test.c", "-I#{include}", "-L#{lib}", "-lgscl", "-o", "test"
    system "./test"
  end
end
