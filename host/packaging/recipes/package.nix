# The expression of nixpkgs (pkgs/by-name/gs/gscl/package.nix).
{
  lib,
  stdenv,
  fetchurl,
  cairo,
  lcms2,
  libjpeg,
  libpng,
  llvmPackages,
  meson,
  ninja,
  opencl-headers,
  openimageio,
  openjpeg,
  pkg-config,
  python3,
  zlib,
}:

stdenv.mkDerivation (finalAttrs: {
  pname = "gscl";
  version = "@VERSION@";

  src = fetchurl {
    url = "@URL@";
    sha256 = "@SHA256@";
  };

  nativeBuildInputs = [
    llvmPackages.clang-unwrapped # compiles the kernels of the processor
    meson
    ninja
    pkg-config
    python3
  ];

  buildInputs = [
    cairo
    lcms2
    libjpeg
    libpng
    opencl-headers
    openimageio
    openjpeg
    zlib
  ];

  postPatch = "patchShebangs cl host";

  mesonFlags = [
    (lib.mesonEnable "tool" true)
    (lib.mesonEnable "tests" false)
    (lib.mesonEnable "web" false)
    (lib.mesonEnable "desktop" false)
  ];

  meta = {
    description = "Image codec that stores a picture as 2D Gaussians";
    homepage = "@HOMEPAGE@";
    license = lib.licenses.bsd2;
    mainProgram = "gscl";
    platforms = lib.platforms.unix;
  };
})
