#!/bin/sh
# host/ and format/ pass the checks of .clang-tidy: check_tidy.sh BUILD
# The build folder has meson's compile_commands.json.  Versions of clang-tidy differ: only 14 decides.
set -eu
build=$(cd "$1" && pwd)
cd "$(dirname "$0")/.."
tidy=$(command -v clang-tidy-14 || command -v clang-tidy)
case $("$tidy" --version) in
*"version 14."*) ;;
*) echo "skipped: not clang-tidy 14"; exit 0 ;;
esac
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT INT TERM
# The library is compiled twice, shared and static, and parts of it for web pages, too: one command a file is enough.
python3 - "$build" >"$work/compile_commands.json" <<'END'
import json, pathlib, sys
build = pathlib.Path(sys.argv[1])
commands = {}
for name in ("host/web/compile_commands.json", "compile_commands.json"):
    if (build / name).exists():
        for command in json.loads((build / name).read_text()):
            commands[(pathlib.Path(command["directory"]) / command["file"]).resolve()] = command
print(json.dumps(list(commands.values())))
END
find host format -name '*.c' | sort | xargs -P "$(nproc)" -n 8 "$tidy" --quiet -p "$work" 2>/dev/null
