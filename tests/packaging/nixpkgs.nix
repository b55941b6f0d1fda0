# For test_recipes.sh: what package.nix takes of nixpkgs, with the machine's own tools and libraries.
{ recipe }:
let
  lib = {
    mesonEnable = name: isOn: "-D${name}=${if isOn then "enabled" else "disabled"}";
    licenses.bsd2 = "BSD-2-Clause";
    platforms.unix = [ builtins.currentSystem ];
  };
  fetchurl = { url, sha256 }: builtins.fetchurl { inherit url sha256; };
  stdenv.mkDerivation =
    make:
    let
      attributes = make attributes;
    in
    derivation {
      name = "${attributes.pname}-${attributes.version}";
      system = builtins.currentSystem;
      builder = "/bin/sh";
      args = [
        "-euc"
        ''
          export PATH=/usr/bin:/bin HOME="$PWD"
          patchShebangs() { ls -d "$@"; }
          tar -xf "$src"
          cd "$pname-$version"
          eval "$postPatch"
          meson setup build --prefix "$out" --libdir lib --buildtype plain $mesonFlags
          ninja -C build
          meson install -C build --no-rebuild
        ''
      ];
      inherit (attributes) pname version src postPatch mesonFlags;
    };
  expression = import recipe;
in
expression (
  builtins.mapAttrs (name: isOptional: { clang-unwrapped = name; }) (builtins.functionArgs expression)
  // { inherit lib stdenv fetchurl; }
)
