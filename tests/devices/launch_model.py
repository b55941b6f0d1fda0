"""A model of the time that launches of kernels take on an NVIDIA H100, from their numbers of work-groups and the boxes of rdo_visit.

Nothing here was measured on a GPU.  The assumptions, each as a low and a high number, between which the time should lie:

 - launches depend on each other, and the next begins GAP after the one before it has ended,
 - a launch takes at least its LATENCY, which was estimated by reading the kernel: the longest chain of instructions of one
   work-item that depend on each other,
 - a launch of many work-groups takes the COST of each, estimated in the same way, where all 132 multiprocessors work,
 - a kernel of ROUND takes that for each number that a work-item adds up in turn, for each scan of begin_lists, or for each pixel of
   a box of rdo_visit,
 - the registers of rdo_visit leave room for one group on a multiprocessor, which takes its latency and the pixels of its box; a launch
   takes as long as the largest box or as all that one of RESIDENT groups visits in turn (low), or both (high),
 - a wait of the host for the device takes WAIT, with what the host does before the device has work again.
"""
MULTIPROCESSORS = 132
GAP = (2.5, 6.0)  # microseconds, as all below
WAIT = (15.0, 40.0)
RESIDENT = MULTIPROCESSORS

# A visit of rdo_visit by the stall counts of the code that ptxas makes for sm_90, at 1.755 GHz, where a load takes 300 cycles: 29,000
# cycles, and with them for each pixel of the outline 2.2 of the model, 3.5 of the moves and 0.8 of the final change.  The outline of a
# splat covers about 0.3 of its box (0.31 at 0.042 bits per pixel of kodim01, 0.24 at 0.183).  High: loads of 500 cycles, and
# a second visit, which splats get that moved.
LATENCY = {
    "rdo_visit": (17, 40),
    "place_splats": (15, 40),
    "fit_tiles": (10, 16),
    "rdo_begin": (8, 14),
    "raster_samples": (8, 14),
    "raster_forward": (6, 12),
    "control_fit": (4, 6),
    "visual_terms_row": (5, 8),
    "begin_lists": (5, 11),
    "bin": (4, 8),
    "sum_loss": (3, 4),
    "begin_control": (3, 4),
    "step_splats": (4, 7),
    "visual_shares": (4, 5),
    "bin_count": (3, 5),
    "project": (3, 4),
}
OTHER_LATENCY = (2.5, 4)

# Nanoseconds of each work-group.
COST = {
    "fit_tiles": (18, 36),
    "rdo_begin": (5.2, 9.8),
    "raster_samples": (5.9, 10.4),
    "raster_forward": (5.2, 9.8),
    "bin": (3.3, 5.2),
    "step_splats": (2, 3.5),
    "bin_count": (2, 3.3),
    "begin_lists": (6, 12),
}
OTHER_COST = (0.5, 1)


# Microseconds of each of what a work-item does in turn, of which `rounds` says how many there are.
ROUND = {
    "rdo_visit": (0.0011, 0.0027),
    "control_fit": (0.06, 0.3),
    "sum_loss": (0.06, 0.3),
    "begin_control": (0.06, 0.3),
    "visual_shares": (0.06, 0.3),
    "begin_lists": (0.7, 1.2),
}
SUM_ITEMS = 64  # work-items that sum, and numbers and splats that a group of begin_control and begin_lists takes
CONTROL_PART = 1024
LISTED_SPLATS = 2048


def rounds(kernel, sizes, largest=0, all_boxes=0):
    """Rounds of a launch, from `sizes`: {kernel: work-groups of its last launch}, of begin_control since the last of control_fit
    and sum_loss.  A tile has a group in fit_tiles, a splat one in step_splats, a row of all scales one in visual_terms_row;
    about half of these are of the largest scale.  Of rdo_visit the pixels of the largest box and of all boxes."""
    if kernel == "rdo_visit":
        return largest, all_boxes
    tiles, splats = sizes.get("fit_tiles", 0), sizes.get("step_splats", 0)
    if kernel == "begin_lists":
        return -(-splats // LISTED_SPLATS)
    if kernel == "begin_control":
        return CONTROL_PART // SUM_ITEMS
    if kernel == "visual_shares":
        return sizes.get("visual_terms_row", 0) // 2 // SUM_ITEMS
    if kernel in ("control_fit", "sum_loss"):
        return sizes.get("begin_control", 0) // SUM_ITEMS or max(tiles, splats) // SUM_ITEMS
    return 0


def visits_us(groups, largest, all_boxes, bound):
    """Microseconds of a launch of rdo_visit without the gap."""
    latency, pixel = LATENCY["rdo_visit"][bound], ROUND["rdo_visit"][bound]
    longest = latency + pixel * largest
    in_turn = (latency * groups + pixel * all_boxes) / RESIDENT
    if groups <= RESIDENT:
        return longest
    return longest + in_turn if bound else max(longest, in_turn)


def launch_us(kernel, groups, bound, count=0):
    """Microseconds of a launch of `count` rounds with the gap before it; bound 0: low, 1: high."""
    if kernel == "rdo_visit":
        return GAP[bound] + visits_us(groups, *count, bound)
    latency = LATENCY.get(kernel, OTHER_LATENCY)[bound] + count * ROUND.get(kernel, (0, 0))[bound]
    return GAP[bound] + max(latency, 1e-3 * COST.get(kernel, OTHER_COST)[bound] * groups)


def kernel_ms(kernel, launches):
    """(low, high) milliseconds of a list of launches of a kernel, each (work-groups, rounds)."""
    return tuple(1e-3 * sum(launch_us(kernel, groups, bound, count) for groups, count in launches) for bound in (0, 1))


def waits_ms(count):
    return tuple(1e-3 * WAIT[bound] * count for bound in (0, 1))
