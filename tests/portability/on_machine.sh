#!/bin/sh
# Runs a program for another machine: on_machine.sh MACHINE PROGRAM [ARGUMENT...]
#
# MACHINE is the name of a file of meson beside this script, whose exe_wrapper is what runs programs.
set -u
here=$(cd "$(dirname "$0")" && pwd)
machine=$1
shift
export PATH="$PATH:$here"
wrapper=$(python3 -c 'import configparser, sys
file = configparser.ConfigParser()
file.read(sys.argv[1])
triple = eval(file.get("constants", "triple", fallback="None"))
wrapper = eval(file.get("binaries", "exe_wrapper", fallback="[]"))
print(*([wrapper] if isinstance(wrapper, str) else wrapper))' "$here/$machine.ini") || exit 1
exec $wrapper "$@"
