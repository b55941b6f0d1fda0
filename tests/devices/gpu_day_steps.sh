# For gpu_day.sh, which reads this file with `.` and runs each function step_NAME in a process of its own.  They find what
# pack_gpu_day.sh made in $package, and may write to $work.  Lines that begin with "= " are results for the summary.

seconds_now() {
    date +%s.%N
}

# since SECONDS: those from then to now.
since() {
    awk "BEGIN { printf \"%.2f\", $(seconds_now) - $1 }"
}

# On the GPU, and on the processor with the kernels of the library.
encode_gpu() {
    gscl encode "$@" --quiet --device 0.0 --mapping gpu
}
encode_host() {
    gscl encode "$@" --quiet --device host
}
decode_gpu() {
    gscl decode "$@" --device 0.0 --mapping gpu
}
decode_host() {
    gscl decode "$@" --device host
}

# field FILE NAME: a number that gscl compare wrote.
field() {
    sed -n "s/^$2  *\([0-9.]*\).*/\1/p" "$1"
}

first_picture() {
    ls "$package"/pictures/*.png | head -n 1
}

# ---- The machine ----------------------------------------------------------------------------------

step_environment() {
    date
    uname -a
    head -n 3 /etc/os-release
    nproc
    grep -m 1 'model name' /proc/cpuinfo
    grep MemTotal /proc/meminfo
    ldd --version | head -n 1
    ls -l /usr/local/nvidia /usr/local/nvidia/lib64 /dev/nvidia* /dev/kfd /dev/dri /etc/OpenCL/vendors 2>/dev/null
    ldconfig -p | grep -i -E 'opencl|libcuda|amdocl'
    [ -z "$library" ] || ldd "$library"
    nvidia-smi 2>/dev/null
    ldd "$package/bin/gscl"
}

step_info() {
    gscl devices && opencl_probe info
}

step_latency() {
    opencl_probe latency
}

# The caches are empty: kernels are built first.
step_first_encode() {
    for run in first second; do
        began=$(seconds_now)
        encode_gpu "$(first_picture)" -o "$work/first.gscl" --bpp 0.042 --tune psnr || return
        echo "= $run encode at 0.042 bpp: $(since "$began") s"
    done
}

step_builds() {
    set -- "$package"/kernels/*.cl
    for file in "$@"; do
        name=$(basename "$file" .cl)
        set -- "$@" "$name"
        shift
    done
    opencl_probe build "$package/kernels" "$@"
}

# ---- Agreement and quality ----------------------------------------------------------------------

# Decoded samples against a drawing in double precision.
step_reference() {
    gscl devices --check --limit 40 >"$work/check.txt"
    code=$?
    sed 's/^/= /' "$work/check.txt"
    return $code
}

# agrees FILE: whether the GPU draws a file like the decoder on the host, but for 1 of 255.
agrees() {
    decode_host "$1" -o "$work/host.png" && decode_gpu "$1" -o "$work/gpu.png" &&
        gscl compare "$work/host.png" "$work/gpu.png" >"$work/compare.txt" &&
        awk "BEGIN { exit !($(field "$work/compare.txt" 'max difference') <= 1) }"
}

step_decodes_agree() {
    agreed=0
    differing=0
    for file in "$package"/conformance/*.gscl; do
        if agrees "$file"; then
            agreed=$((agreed + 1))
        else
            differing=$((differing + 1))
            echo "= differs: $(basename "$file")"
        fi
        [ "$(date +%s)" -lt $((DAY_END - 3)) ] || break
    done
    echo "= $agreed of $((agreed + differing)) files are drawn as on the host, but for 1 of 255"
    [ "$differing" = 0 ]
}

# psnr DEVICE PICTURE OPTIONS...: of an encode there, decoded on the host.
psnr() {
    device=$1
    picture=$2
    shift 2
    "encode_$device" "$picture" -o "$work/quality.gscl" "$@" && decode_host "$work/quality.gscl" -o "$work/quality.png" &&
        gscl compare "$picture" "$work/quality.png" >"$work/quality.txt" && field "$work/quality.txt" PSNR
}

# quality NAME OPTIONS...: each picture on both, and the mean difference; fails where the GPU is 0.3 dB worse.
quality() {
    name=$1
    shift
    : >"$work/differences"
    for picture in $(ls "$package"/pictures/*.png | head -n "$pictures"); do
        gpu=$(psnr gpu "$picture" "$@") && host=$(psnr host "$picture" "$@") || return
        echo "$name, $(basename "$picture"): GPU $gpu dB, host $host dB"
        echo "$gpu $host" >>"$work/differences"
    done
    awk -v name="$name" '{ sum += $1 - $2 }
        END { printf "= %s: the GPU differs from the host by %+.3f dB in the mean of %d\n", name, sum / NR, NR; exit sum / NR < -0.3 }' \
        "$work/differences"
}

step_quality() {
    code=0
    pictures=6
    quality "0.042 bpp, psnr" --bpp 0.042 --tune psnr || code=1
    quality "0.183 bpp, psnr" --bpp 0.183 --tune psnr || code=1
    quality "0.042 bpp, visual" --bpp 0.042 --tune visual || code=1
    pictures=1
    quality "paper profile" --profile paper --bpp 0.1 || code=1
    return $code
}

# ---- Time -----------------------------------------------------------------------------------------

# The kernels of a decode run without the read-back and without the host's part.
summarise_bench() {
    awk '/^(encode|decode), / { print "= " $0; is_decode = /^decode/; in_kernels = 0 }
        /^  (stages|kernels)$/ { in_kernels = /kernels/; sum = 0 }
        is_decode && in_kernels && $3 == "x" { sum += $4 }
        /^$/ && is_decode { printf "=     its kernels alone, without read-back: %.3f ms\n", sum; is_decode = 0 }
        END { if (is_decode) printf "=     its kernels alone, without read-back: %.3f ms\n", sum }' "$1"
}

step_bench() {
    gscl bench "$(first_picture)" --device 0.0 --mapping gpu --tune psnr --encodes 3 --repetitions 20 >"$work/bench.txt"
    code=$?
    cat "$work/bench.txt"
    summarise_bench "$work/bench.txt"
    return $code
}

# timed NAME COMMAND...: the fastest of three processes, whose kernels are built.
timed() {
    name=$1
    shift
    : >"$work/times"
    for run in 1 2 3; do
        began=$(seconds_now)
        "$@" || return
        since "$began" >>"$work/times"
        echo >>"$work/times"
    done
    echo "= $name: $(sort -n "$work/times" | head -n 1) s"
}

step_processes() {
    picture=$(first_picture)
    for bpp in 0.042 0.183; do
        for tune in psnr visual; do
            timed "encode at $bpp bpp, $tune" encode_gpu "$picture" -o "$work/process.gscl" --bpp $bpp --tune $tune || return
        done
        timed "decode at $bpp bpp on the GPU" decode_gpu "$work/process.gscl" -o "$work/process.png" &&
            timed "decode at $bpp bpp on the host" decode_host "$work/process.gscl" -o "$work/process.png" || return
    done
}

# Twice as many pictures as there are workers, at least 12.
step_batches() {
    for workers in 1 2 4 8 16; do
        rm -rf "$work/batch"
        mkdir "$work/batch" || return
        for copy in 1 2 3 4; do
            for picture in "$package"/pictures/*.png; do
                ln -s "$picture" "$work/batch/$copy-$(basename "$picture")"
            done
        done
        set -- $(ls "$work"/batch/*.png | head -n $((workers < 6 ? 12 : 2 * workers)))
        began=$(seconds_now)
        encode_gpu "$@" --out-dir "$work/batch/out" --bpp 0.042 --tune psnr --jobs $workers || return
        awk "BEGIN { printf \"= %d workers: %.2f images/s\n\", $workers, $# / $(since "$began") }"
    done
}

step_large() {
    for tune in psnr visual; do
        began=$(seconds_now)
        encode_gpu "$package/large.jpg" -o "$work/large.gscl" --bpp 0.1 --tune $tune || return
        echo "= large picture, encode, $tune: $(since "$began") s, $(wc -c <"$work/large.gscl") bytes"
    done
    for device in gpu host; do
        began=$(seconds_now)
        "decode_$device" "$work/large.gscl" -o "$work/large-$device.png" || return
        echo "= large picture, decode to a PNG, $device: $(since "$began") s"
    done
    gscl compare "$work/large-host.png" "$work/large-gpu.png" >"$work/compare.txt"
    echo "= large picture, decodes differ by at most $(field "$work/compare.txt" 'max difference') of 255"
    nvidia-smi --query-gpu=memory.used,utilization.gpu,clocks.sm --format=csv 2>/dev/null || true
}

# Tunables are constants of a build: other values need other libraries.
step_variants() {
    if [ ! -d "$package/variants" ]; then
        echo "= left out: the package has no builds with other tunables"
        return 0
    fi
    for folder in "$package"/variants/*; do
        LD_LIBRARY_PATH=$folder:$LD_LIBRARY_PATH gscl bench "$(first_picture)" --device 0.0 --mapping gpu --tune psnr --encodes 2 \
            --repetitions 5 >"$work/variant.txt" || return
        echo "#### variant $(basename "$folder")"
        cat "$work/variant.txt"
        echo "= variant $(basename "$folder")"
        summarise_bench "$work/variant.txt"
    done
}

# ---- Tests ----------------------------------------------------------------------------------------

# one_test FILE: until the step ends.
one_test() {
    name=$(basename "$1")
    GSCL_TEST_DEVICE=0.0 STABILITY_SMALL=1 CMOCKA_MESSAGE_OUTPUT=TAP timeout -k 1 $((DAY_END - $(date +%s) - 3)) "$1" >"$work/$name.txt" 2>&1
    code=$?
    case $code in
    124 | 137) state="cut" ;;
    *) state="exits with $code" ;;
    esac
    echo "= $name $state: $(grep -c '^ok' "$work/$name.txt") passed, $(grep -c '^not ok' "$work/$name.txt") failed"
    grep -A 5 '^not ok' "$work/$name.txt"
    return $code
}

# Four at a time: most of their time is the host's.
step_tests() {
    ls "$package"/tests/* | xargs -P 4 -I '{}' sh -c '. "$package/gpu_day_steps.sh"; one_test "$1"' one_test '{}'
}
