"""What the kernels of the GPU mapping may take at most on each device (compilers.py).  The limits are the figures of the day on
which they were written: lower them where a kernel shrinks, and never raise them."""

# Bytes of private memory of a work-item of rdo_visit.  It takes less than half, but compilers of drivers differ, and a device
# reserves them for all work-items that it can run at once, in each of its contexts: 1 KiB takes 270 MB of an H100.
RDO_STACK = 512
# Kinds of programs whose kernels spill no vector register.
UNSPILLED = {"render", "fit", "bin", "visual"}

# Registers of a work-item of the kernels of the visual loss that take most, on NVIDIA's GPUs.
REGISTERS = {
    "visual_by_luminance_strip": {"sm_75": 96, "sm_90": 80},
    "visual_maps_row": {"sm_75": 64, "sm_90": 64},
    "visual_terms_row": {"sm_75": 64, "sm_90": 64},
}


def breaches(program, kernels):
    """What a program's kernels take above the limits, in words; `kernels`: {kernel: {device: {column: number}}}"""
    if program.mapping != "gpu":
        return
    for kernel, devices in kernels.items():
        for device, figures in devices.items():
            spilled = figures.get("spilled", 0)
            if spilled and program.kind in UNSPILLED:
                yield f"{kernel} spills {spilled} on {device}"
            registers, most = figures.get("registers", 0), REGISTERS.get(kernel, {}).get(device)
            if most is not None and registers > most:
                yield f"{kernel} takes {registers} registers on {device}, {most} at most"
            stack = figures.get("stack", figures.get("scratch", 0))
            if kernel == "rdo_visit" and stack > RDO_STACK:
                yield f"{kernel} takes {stack} bytes of private memory on {device}, {RDO_STACK} at most"
