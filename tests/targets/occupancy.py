"""How many work-items a multiprocessor of NVIDIA's GPUs runs at once."""
import collections

WARP = 32
REGISTER_UNIT = 8  # registers of a work-item are allocated in such steps

# Of a multiprocessor: registers, work-items, work-groups and bytes of shared memory; and the bytes that the driver takes of each group.
Multiprocessor = collections.namedtuple("Multiprocessor", "registers items groups shared reserved")
MULTIPROCESSORS = {
    "sm_75": Multiprocessor(65536, 1024, 16, 64 << 10, 0),
    "sm_90": Multiprocessor(65536, 2048, 32, 228 << 10, 1 << 10),  # H100
}


def resident_groups(device, figures, group_size):
    """Work-groups that a multiprocessor runs at once; `figures`: of ptxas.py."""
    one = MULTIPROCESSORS[device]
    items = -(-group_size // WARP) * WARP
    registers = -(-figures["registers"] // REGISTER_UNIT) * REGISTER_UNIT * items
    shared = figures["shared"] + one.reserved
    bounds = [one.groups, one.items // items, one.registers // registers]
    return min(bounds + ([one.shared // shared] if shared else []))


def occupancy(device, figures, group_size):
    """The share of the work-items that could run if nothing but their number was a bound; lanes without one count as work-items."""
    items = -(-group_size // WARP) * WARP
    return resident_groups(device, figures, group_size) * items / MULTIPROCESSORS[device].items
