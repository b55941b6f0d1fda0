"""The source files of all programs, and the programs that cl/native.py compiles into the library.

A program is a kind of gscl_program_kind (host/lib/runtime/kernel_options.h) with options.  One that is specialised serves
just these options; a general one (options.h) serves all that have its channels.
"""
from typing import NamedTuple, Optional

# Of each program, behind the declarations of built-in functions: builtins.h, or native.h.
COMMON = ["constants.h", "structs.h", "macros.h", "options.h"]
# From parameters to projected splats.
SPLATS = ["splat_lanes.cl", "direction.cl", "project.cl"]
# The further files of each kind, in the order in which the compiler reads them.
FILES = {
    "RENDER": ["pixel.cl", "raster.cl", "draw.cl", *SPLATS, "splats.cl", "samples.cl"],
    "BIN": ["group_scan.cl", "links.cl", "bin.cl"],
    "FIT": ["pixel.cl", "raster.cl", *SPLATS, "slots.cl", "fit.cl", "update.cl", "step.cl"],
    "GRADIENTS": ["pixel.cl", *SPLATS, "slots.cl", "update.cl", "gradients.cl"],
    "SCALAR_RDO": ["pixel.cl", "raster.cl", *SPLATS, "rdo_items.cl", "outline.cl", "scalar_codes.cl", "rdo_planes.cl",
                   "rdo_colour.cl", "rdo_moves.cl", "rdo_model.cl", "texture.cl", "scalar_rdo.cl"],
    "CODEBOOK": ["pixel.cl", "raster.cl", *SPLATS, "slots.cl", "update.cl", "rdo_items.cl", "outline.cl",
                 "codebook.cl", "codebook_rdo.cl"],
    "SSIM": ["pixel.cl", "ssim.cl"],
    "VISUAL": ["pixel.cl", "group_sum.cl", "visual.cl"],
    "IMAGE": ["image.cl", "group_sum.cl", "group_scan.cl", "sums.cl", "random.h", "placement.cl"],
    "BENCHMARK": ["pixel.cl", "benchmark.cl"],
    "ACCURACY": ["pixel.cl", "raster.cl", "draw.cl", "accuracy.cl"],  # OpenCL only
}
# Kinds whose kernels depend on what splats have and how they are blended, so that there is a general program of each.
OF_SPLATS = ["RENDER", "FIT", "GRADIENTS", "SCALAR_RDO", "CODEBOOK"]
# Those that take a vector of splats at once (gscl_splat_lanes).
WIDE = ["FIT", "GRADIENTS"]

# The CPU mapping (host/lib/runtime/mapping.c), in groups of one work-item.
MAPPING = {"LANES": "GSCL_CPU_LANES", "ROWS": "GSCL_CPU_ROWS", "CACHED_ROWS": "GSCL_CPU_CACHED_ROWS", "SLOT_ITEMS": 1,
           "RDO_ITEMS": 1, "BAND_ITEMS": 1, "BIN_ITEMS": 1, "LINK_SPLATS": "GSCL_CPU_LINK_SPLATS"}


class Options(NamedTuple):
    """What a specialised program serves: fields of gscl_kernel_options."""
    blend: int = 0  # GSCL_NORMALIZED
    opacity: int = 0
    texture: int = 0
    shape: int = 0  # GSCL_SHAPE_ROTATED
    loss: int = 0  # GSCL_LOSS_KIND_L2
    weighted: int = 0  # GSCL_WEIGHTED_NOT


class Program(NamedTuple):
    """One program.  colours and alpha_channel are 0 where its kernels do not depend on channels."""
    kind: str
    colours: int = 0
    alpha_channel: int = 0
    options: Optional[Options] = None  # None: general, or a kind without options

    @property
    def name(self):
        """Of its object file and its symbols."""
        text = self.kind.lower()
        if self.colours:
            text += f"_{self.colours}{self.alpha_channel}"
        return text + ("_" + "".join(map(str, self.options)) if self.options else "")

    @property
    def is_general(self):
        return self.kind in OF_SPLATS and self.options is None

    def defines(self):
        """The macros that it is compiled with."""
        macros = dict(MAPPING, SPLAT_LANES="GSCL_CPU_SPLAT_LANES" if self.kind in WIDE else 1)
        if self.colours:
            macros.update(COLOURS=self.colours, ALPHA_CHANNEL=self.alpha_channel)
        if self.options:
            macros.update({name.upper(): value for name, value in self.options._asdict().items()})
        if self.is_general:
            macros["GENERAL"] = 1
        return macros


CHANNELS = [(1, 0), (1, 1), (3, 0), (3, 1)]


def specialised():
    """The programs of encodes with the default settings: splats that are opaque ellipses, in colour images."""
    for texture in (0, 1):
        yield Program("RENDER", 3, 0, Options(texture=texture))
    for weighted in (0, 1, 2):
        yield Program("FIT", 3, 0, Options(weighted=weighted))
        for texture in (0, 1):
            yield Program("SCALAR_RDO", 3, 0, Options(texture=texture, weighted=weighted))
    yield Program("FIT", 1, 0, Options())


def programs():
    """All programs; of those that serve the same options the first is taken."""
    result = list(specialised())
    for channels in CHANNELS:
        result += [Program(kind, *channels) for kind in [*OF_SPLATS, "SSIM", "VISUAL"]]
    return result + [Program("BIN"), Program("IMAGE"), Program("BENCHMARK", 1, 0)]
