#!/bin/sh
# What gscl wants to know of a GPU, in one call of at most 8 minutes, on a machine without packages:
#     [OUT=FOLDER] sh gpu_day.sh [auto | LIBRARY | FILE.icd]
#
# It runs in the folder that pack_gpu_day.sh made.  `auto` finds the OpenCL library of NVIDIA's or AMD's driver; any other one can
# be named, as can that of PoCL in place of a GPU (/etc/OpenCL/vendors/pocl.icd).  Exits with 3 where there is none, and with 1
# where a step failed.
#
# Each step (gpu_day_steps.sh) has a limit of its own, at which it is cut, and the next one begins; all of them end after DAY_LIMIT
# seconds (470).  What a step writes goes to a file in OUT (./out) as it comes, and summary.txt has a line for each step, with the
# results that it printed after "= ".  DAY_STEPS="environment smoke" runs these steps alone; no step takes more than DAY_STEP_LIMIT
# seconds.
set -u
package=$(cd "$(dirname "$0")" && pwd)
export package
. "$package/gpu_day_steps.sh"

# In a step: gpu_day.sh --step NAME
if [ "${1:-}" = --step ]; then
    "step_$2"
    exit
fi

start=$(date +%s)
limit=${DAY_LIMIT:-470}
out=${OUT:-$PWD/out}
mkdir -p "$out"
work=$(mktemp -d)
export work
step=
trap 'end_step; rm -rf "$work"' EXIT
trap 'exit 130' INT TERM HUP
failed=0
: >"$out/summary.txt"

say() {
    echo "$*" | tee -a "$out/summary.txt"
}

is_wanted() {
    [ -z "${DAY_STEPS:-}" ] && return 0
    case " $DAY_STEPS " in *" $1 "*) return 0 ;; esac
    return 1
}

# limit_of SECONDS: the least of the step's limit and what is left.
limit_of() {
    seconds=$1
    left=$((start + limit - $(date +%s)))
    for other in $left ${DAY_STEP_LIMIT:-}; do
        [ "$other" -ge "$seconds" ] || seconds=$other
    done
    echo "$seconds"
}

# Ends what the step has left, such as a gscl that hangs in the driver: timeout has made it a process group of its own.
end_step() {
    [ -z "$step" ] || kill -s KILL -- "-$step" 2>/dev/null
    step=
}

# run_step NAME SECONDS FILE: in a process of its own, which can be cut.
run_step() {
    is_wanted "$1" || return 0
    seconds=$(limit_of "$2")
    if [ "$seconds" -lt 1 ]; then
        say "$1: no time left"
        failed=1
        return 1
    fi
    began=$(date +%s)
    DAY_END=$((began + seconds)) timeout "$seconds" sh "$package/gpu_day.sh" --step "$1" >"$work/step.txt" 2>&1 &
    step=$!
    wait "$step"
    code=$?
    end_step
    { echo "#### $1" && cat "$work/step.txt" && echo; } >>"$out/$3.txt"
    case $code in
    0) state=done ;;
    124) state="CUT at its limit" ;;
    *) state="FAILED ($code)" ;;
    esac
    say "$1: $state, $(($(date +%s) - began)) s"
    sed -n 's/^= /    /p' "$work/step.txt" | tee -a "$out/summary.txt"
    [ "$code" = 0 ] || failed=1
    return "$code"
}

# The OpenCL library of a GPU's driver, or nothing.
find_library() {
    for name in libnvidia-opencl.so.1 libamdocl64.so; do
        for parent in /usr/local/nvidia/lib64 /usr/local/nvidia/lib /usr/lib/x86_64-linux-gnu /usr/lib64 /opt/rocm/lib /usr/lib/wsl/lib; do
            [ ! -e "$parent/$name" ] || { echo "$parent/$name"; return; }
        done
        found=$(ldconfig -p 2>/dev/null | sed -n "s/^[[:space:]]*$name .*=> //p" | head -n 1)
        [ -n "$found" ] || found=$(timeout 20 find /usr /opt -xdev -name "$name" 2>/dev/null | head -n 1)
        [ -z "$found" ] || { echo "$found"; return; }
    done
}

# open_library WHAT: sets $library and tells the loader of it, whichever it is.
open_library() {
    case $1 in
    auto) library=$(find_library) ;;
    *.icd) library=$(cat "$1" 2>/dev/null) ;;
    *) library=$(ls "$1" 2>/dev/null) ;;
    esac
    mkdir "$work/vendors"
    echo "$library" >"$work/vendors/gpu.icd"
    export library OCL_ICD_VENDORS="$work/vendors/gpu.icd" OCL_ICD_FILENAMES="$library"
    case $library in */*) library_folder=:$(dirname "$library") ;; *) library_folder= ;; esac
    export LD_LIBRARY_PATH="$package/library:$package/lib$library_folder${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}"
    export PATH="$package/bin:$PATH"
}

# Caches of built kernels are empty: the first encode takes as long as on a new machine.
own_caches() {
    mkdir "$work/home"
    export HOME="$work/home" XDG_CACHE_HOME="$work/cache" TMPDIR="$work" CUDA_CACHE_PATH="$work/cuda" MESA_SHADER_CACHE_DIR="$work/mesa"
    export POCL_CACHE_DIR="${DAY_POCL_CACHE:-$work/pocl}" POCL_SIGFPE_HANDLER=0
}

own_caches
open_library "${1:-auto}"
say "OpenCL library: ${library:-none}"
run_step environment 30 environment
if [ -z "$library" ]; then
    say "There is no OpenCL library of a GPU: nothing else can run."
    exit 3
fi
run_step info 30 environment
run_step latency 40 environment
run_step first_encode 90 environment
run_step builds 90 builds
run_step reference 90 agreement
run_step decodes_agree 60 agreement
run_step quality 100 quality
run_step bench 60 speed
run_step processes 30 speed
run_step batches 60 speed
run_step large 70 large
run_step variants 90 speed
run_step tests 300 tests
say "All steps took $(($(date +%s) - start)) s."
exit $failed
