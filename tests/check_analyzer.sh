#!/bin/sh
# The analyzer of gcc finds nothing in the C files of host/ and format/: check_analyzer.sh BUILD
# The build folder has meson's compile_commands.json.  Versions of gcc differ: only 12 decides.
#
# All classes of reports are on.  Where one is false, write the code so that it is seen to be right within its file: memory of
# many owners in one allocation, one variable for what has been allocated, no loop that might run zero times.
set -eu
build=$(cd "$1" && pwd)
cd "$(dirname "$0")/.."
gcc=$(command -v gcc-12 || command -v gcc)
case $("$gcc" -dumpversion) in
12 | 12.*) ;;
*) echo "skipped: not gcc 12"; exit 0 ;;
esac
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT INT TERM

# Without optimisation it sees more and takes half of the time.  __clang_analyzer__: see gscl_fail in runtime/context.h.
analyse="$gcc -O0 -fanalyzer -Werror -D__clang_analyzer__ -S -o /dev/null"

# It must see what it is there for.
cat >"$work/faults.c" <<'END'
#include <stdio.h>
#include <stdlib.h>
void free_twice(char *p) { free(p), free(p); }
char use_freed(char *p) { free(p); return *p; }
void use_null(void) { char *p = malloc(8); *p = 0; free(p); }
int read_nothing(void) { int i; return i; }
int leak_memory(void) { return malloc(8) != NULL; }
int leak_file(void) { return fopen("a", "r") != NULL; }
END
$analyse "$work/faults.c" 2>"$work/found" || true
for class in double-free use-after-free possible-null-dereference use-of-uninitialized-value malloc-leak file-leak; do
    grep -q "analyzer-$class" "$work/found" || { echo "gcc does not find a planted fault: $class"; exit 1; }
done

# Of each command what the sources need; those for web pages are for clang.
python3 tests/compile_commands.py "$build" | python3 -c '
import json, shlex, sys
for command in json.load(sys.stdin):
    words = shlex.split(command.get("command", ""))
    if words and command["file"].startswith(("../host/", "../format/")) and command["file"].endswith(".c"):
        print(shlex.join([word for word in words if word[:2] in ("-I", "-D") or word[:5] == "-std="] + [command["file"]]))
' >"$work/commands"
cd "$build"
xargs -P "$(nproc)" -d '\n' -I COMMAND sh -c "$analyse COMMAND" <"$work/commands"
