"""What the kernels of the GPU mapping may take at most on each device (compilers.py).  The limits are the figures of the day on
which they were written: lower them where a kernel shrinks, and never raise them."""

# Bytes of private memory of a work-item of rdo_visit.  It takes less than half, but compilers of drivers differ, and a device
# reserves them for all work-items that it can run at once, in each of its contexts: 1 KiB takes 270 MB of an H100.
RDO_STACK = {"PTX": 512, "sm_75": 512, "sm_90": 512, "gfx90a": 512}
# But on gfx1100, where clang 15 takes only 128 of its 256 vector registers, whatever the size of the work-groups: by the use of the
# program (list_programs.c), and those of all others at most.
RDO_STACK_GFX1100 = {"encode": 544, "encode, waves": 1152}
RDO_STACK_GFX1100_OTHERS = 1376

# Kinds of programs whose kernels spill no vector register.
UNSPILLED = {"render", "fit", "bin", "visual"}
# But fit_tiles on gfx1100, for the same reason: the registers that it spills, by the use of the program, and those of all others
# at most.
SPILLED = {"encode": 0, "encode, waves": 40}
SPILLED_BY_OTHERS = 95

# Registers of a work-item of the kernels of the visual loss that take most, on NVIDIA's GPUs.
REGISTERS = {
    "visual_by_luminance_strip": {"sm_75": 96, "sm_90": 80},
    "visual_maps_row": {"sm_75": 64, "sm_90": 64},
    "visual_terms_row": {"sm_75": 64, "sm_90": 64},
}


def spilled_limit(program, kernel, device):
    """None where there is none."""
    if program.kind not in UNSPILLED:
        return None
    if (device, kernel) == ("gfx1100", "fit_tiles"):
        return SPILLED.get(program.use, SPILLED_BY_OTHERS)
    return 0


def stack_limit(program, kernel, device):
    """None where there is none."""
    if kernel != "rdo_visit":
        return None
    if device == "gfx1100":
        return RDO_STACK_GFX1100.get(program.use, RDO_STACK_GFX1100_OTHERS)
    return RDO_STACK[device]


def breaches(program, kernels):
    """What a program's kernels take above the limits, in words; `kernels`: {kernel: {device: {column: number}}}"""
    if program.mapping != "gpu":
        return
    for kernel, devices in kernels.items():
        for device, figures in devices.items():
            spilled, most = figures.get("spilled", 0), spilled_limit(program, kernel, device)
            if most is not None and spilled > most:
                yield f"{kernel} spills {spilled} on {device}, {most} at most"
            registers, most = figures.get("registers", 0), REGISTERS.get(kernel, {}).get(device)
            if most is not None and registers > most:
                yield f"{kernel} takes {registers} registers on {device}, {most} at most"
            stack, most = figures.get("stack", figures.get("scratch", 0)), stack_limit(program, kernel, device)
            if most is not None and stack > most:
                yield f"{kernel} takes {stack} bytes of private memory on {device}, {most} at most"
