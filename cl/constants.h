/* The kernels: all OpenCL C of gscl, which draws splats and fits them, and the constants and structs that the host
 * shares with it.  The build embeds the files; host/lib/opencl/program.c joins them to programs.
 *
 * In the order in which to read them:
 *   constants.h, structs.h: what the host reads as well
 *   builtins.h, macros.h, options.h, pixel.cl, splat_lanes.cl: vectors of pixels and of splats
 *   group_scan.cl, group_sum.cl: prefix sums and sums over a work-group
 *   direction.cl, project.cl, splats.cl, links.cl, bin.cl, raster.cl, draw.cl, samples.cl: from parameters to an image
 *   slots.cl, fit.cl, update.cl, step.cl, gradients.cl, image.cl, sums.cl, ssim.cl, visual.cl: from an image to
 *     gradients, and a step of the optimiser
 *   random.h, placement.cl: where splats are added
 *   rdo_items.cl, outline.cl, scalar_codes.cl, rdo_planes.cl, rdo_colour.cl, rdo_moves.cl, rdo_model.cl, texture.cl,
 *     scalar_rdo.cl: rate-distortion optimisation of scalar codes
 *   codebook.cl, codebook_rdo.cl: codebooks of the paper profile
 *   accuracy.cl, benchmark.cl: measurements
 *   native.h, programs.py, native.py: kernels that are compiled with the library (host/lib/native)
 *
 * This file has the constants.  Those that the file format fixes say so; changing one of these changes what every file
 * looks like. */
#ifndef GSCL_CL_CONSTANTS_H
#define GSCL_CL_CONSTANTS_H

/* A tile is the unit of binning and of work: one work-group draws one tile. */
#define GSCL_TILE 16
/* Work-items of the work-groups of kernels (GROUP_OF in macros.h), as far as they are no build options
 * (host/lib/runtime/mapping.h): of a group that draws a tile, whose work-items take `rows` rows of `lanes` pixels; of one
 * that takes GSCL_SPLATS_PER_GROUP splats, whose work-items take `splat_lanes` of them; and of kernels whose work-items take a
 * pixel of an image, or a dimension or a word of a codebook, each; of the benchmark. */
#define GSCL_TILE_ITEMS(lanes, rows) ((GSCL_TILE / (lanes)) * (GSCL_TILE / (rows)))
#define GSCL_SPLATS_PER_GROUP 32
#define GSCL_SPLAT_ITEMS(splat_lanes) (GSCL_SPLATS_PER_GROUP / (splat_lanes))
#define GSCL_IMAGE_GROUP 64
#define GSCL_BOOK_GROUP 1
#define GSCL_BENCHMARK_GROUP 64
/* Splats whose links are counted together (links.cl). */
#define GSCL_LINK_BLOCK 64
/* The most tiles of a row whose splats are counted where they are listed: 2 KB of local memory (cl/bin.cl). */
#define GSCL_COUNTED_TILES 512
/* Splats of a tile that are summed one after another when an image is drawn (raster.cl). */
#define GSCL_RUN 1024

/* The CPU mapping (gscl_runtime_tunables in host/lib/runtime/tunables.h says what each is), which kernels that are compiled with
 * the library have, too. */
#define GSCL_CPU_LANES 16
#define GSCL_CPU_ROWS 16
#define GSCL_CPU_CACHED_ROWS 512
#ifndef GSCL_CPU_SPLAT_LANES
#define GSCL_CPU_SPLAT_LANES 16
#endif
#define GSCL_CPU_LINK_SPLATS 64

/* Blend modes, numbered as in the file format. */
#define GSCL_NORMALIZED 0
#define GSCL_ALPHA 1
#define GSCL_SUM 2

/* Format: a splat's weight is max(0, exp(-q) - exp(-GSCL_SUPPORT)), continuous at the cut q = GSCL_SUPPORT. */
#ifndef GSCL_SUPPORT /* other values are for measurements (host/lib/measure/accuracy.c) */
#define GSCL_SUPPORT 7.0f
#define GSCL_WEIGHT_FLOOR 9.1188197e-4f
#endif
/* Format: weight of the background in `normalized`. */
#define GSCL_EPSILON 9.765625e-4f
/* Format: the largest alpha of a splat in blend `alpha`; bounds 1 / (1 - a) by 1000. */
#ifndef GSCL_MAX_ALPHA
#define GSCL_MAX_ALPHA 0.999f
#endif

/* A splat's parameters while fitting; lengths are pixels of the full-size image. */
#define GSCL_X 0
#define GSCL_Y 1
#define GSCL_LOG_S1 2 /* natural logarithm of the first axis (sigma, pixels) */
#define GSCL_LOG_S2 3
#define GSCL_THETA 4   /* direction of the first axis, radians from +x towards +y */
#define GSCL_OPACITY 5 /* logit of the opacity; no effect where the opacity effect is off */
#define GSCL_COLOUR 6  /* up to four channels follow */
/* The wave of the texture is drawn but not fitted. */
#define GSCL_WAVE_X 10         /* cycles per pixel along x */
#define GSCL_WAVE_Y 11         /* cycles per pixel along y */
#define GSCL_WAVE_PHASE 12     /* cycles */
#define GSCL_WAVE_AMPLITUDE 13 /* 0: no wave */
#define GSCL_PARAMS 14

/* A projected splat as the rasteriser reads it (floats).  (UX, UY) and (VX, VY) take (dx, dy), the place from the
 * centre, into the splat's own frame (u, v), where gauss = 2^-(u^2 + v^2).  ROW_STEP is 2^-(UY^2 + VY^2), the factor of
 * one step to the next row from the centre. */
#define GSCL_PROJECTED_X 0
#define GSCL_PROJECTED_Y 1
#define GSCL_PROJECTED_UX 2
#define GSCL_PROJECTED_UY 3
#define GSCL_PROJECTED_VX 4
#define GSCL_PROJECTED_VY 5
#define GSCL_PROJECTED_OPACITY 6
#define GSCL_PROJECTED_ROW_STEP 7
#define GSCL_PROJECTED_COLOUR 8
#define GSCL_PROJECTED_WAVE_X 12 /* cycles per pixel */
#define GSCL_PROJECTED_WAVE_Y 13
#define GSCL_PROJECTED_WAVE_PHASE 14 /* cycles */
#define GSCL_PROJECTED_WAVE_AMPLITUDE 15
#define GSCL_PROJECTED 16

/* The bounds of a splat's ellipse q = GSCL_SUPPORT (floats).  On the outline, dy at a given dx is
 *     slope * dx +- sqrt(max(0, height2 - curve * dx^2));
 * dx at a given dy follows likewise from SLOPE_X, WIDTH2, CURVE_X. */
#define GSCL_BOUNDS_HALF_WIDTH 0
#define GSCL_BOUNDS_HALF_HEIGHT 1
#define GSCL_BOUNDS_SLOPE 2
#define GSCL_BOUNDS_HEIGHT2 3
#define GSCL_BOUNDS_CURVE 4
#define GSCL_BOUNDS_SLOPE_X 5
#define GSCL_BOUNDS_WIDTH2 6
#define GSCL_BOUNDS_CURVE_X 7
#define GSCL_BOUNDS 8

/* An entry of a tile's list: the number of a splat and the rows of the tile that its outline touches. */
#define GSCL_ENTRY_SPLAT(e) ((e) >> 8)
#define GSCL_ENTRY_FIRST_ROW(e) (((e) >> 4) & 15u)
#define GSCL_ENTRY_LAST_ROW(e) ((e)&15u)
#define GSCL_ENTRY(splat, first, last) (((splat) << 8) | ((first) << 4) | (last))

/* Format: ln of 2^15 pixels, the longest axis; larger codes saturate. */
#define GSCL_LOG_LARGEST_AXIS 10.3972077f
/* Format: ln of 256: the shorter axis of a splat counts as at least 1 / 256 of the longer one. */
#define GSCL_LOG_LARGEST_ASPECT 5.54517744f

/* How kernels evaluate a Gaussian: a polynomial, or the device's exp2 or native_exp2. */
#define GSCL_EXPONENTIAL_POLYNOMIAL 0
#define GSCL_EXPONENTIAL_EXACT 1
#define GSCL_EXPONENTIAL_NATIVE 2

/* Kinds of samples of an image in memory, numbered as in gscl_sample. */
#define GSCL_SAMPLE_KIND_U8 1
#define GSCL_SAMPLE_KIND_U16 2
#define GSCL_SAMPLE_KIND_F32 3

/* Shapes of splats, from the most general: ellipses, axis-aligned ellipses (angle 0), circles (both axes equal). */
#define GSCL_SHAPE_ROTATED 0
#define GSCL_SHAPE_AXIS_ALIGNED 1
#define GSCL_SHAPE_ISOTROPIC 2

/* Losses of the fit. EXTERNAL: the derivative of the loss is read from an image. */
#define GSCL_LOSS_KIND_L2 0
#define GSCL_LOSS_KIND_L1 1
#define GSCL_LOSS_KIND_EXTERNAL 2

/* Steps for which a tile without error is skipped (cl/fit.cl), found by trying. */
#define GSCL_SKIP_STEPS 7

/* Adam (cl/update.cl, cl/codebook.cl). */
#define GSCL_ADAM_BETA1 0.9f
#define GSCL_ADAM_BETA2 0.99f
#define GSCL_ADAM_LOG2_BETA1 -0.152003093f
#define GSCL_ADAM_LOG2_BETA2 -0.0144995697f
#define GSCL_ADAM_EPSILON 1e-10f

/* Learning rates, found by trying: the change of a parameter in one step at a rate factor of 1, where its gradient is
 * constant. */
#define GSCL_RATE_POSITION 0.06f /* in lengths of an axis, along it */
#define GSCL_RATE_SHAPE 0.08f    /* ln sigma */
#define GSCL_RATE_ANGLE 0.06f    /* radians, of a circular splat; less for elongated ones */
#define GSCL_RATE_COLOUR 0.012f  /* of the range 0..1 */
#define GSCL_RATE_OPACITY 0.04f  /* logit */
#define GSCL_MAX_LOGIT 8.0f      /* bound on a fitted opacity, positive and negative */
#define GSCL_OPAQUE 40.0f        /* the logit of splats without an opacity: 1 when rounded to a float */

/* Quantiser settings (floats) of scalar coding, in the units of the parameters. */
#define GSCL_STEP_SCALE 0    /* step of ln sigma */
#define GSCL_STEP_POSITION 1 /* side of a cell of positions, in major axes */
#define GSCL_STEP_ANGLE 2    /* angle step is this / (aspect - 1/aspect) */
#define GSCL_STEP_LUMA 3
#define GSCL_STEP_CHROMA 4
#define GSCL_STEP_ALPHA 5
#define GSCL_STEP_OPACITY 6   /* number of levels */
#define GSCL_STEP_AMPLITUDE 7 /* of a texture */
/* The areas of splats from which on their levels of luma and chroma have 2, 3, ... parts (gsf_finer_from in
 * format/quantiser.h): products of the axes in 1/32 octaves above 1/4 square pixel, less a half against rounding. */
#define GSCL_STEP_FINER 8
#define GSCL_MAX_FINENESS 8
#define GSCL_STEP_COUNT (GSCL_STEP_FINER + GSCL_MAX_FINENESS - 1)

/* Multiply-adds of the benchmark on each lane (cl/benchmark.cl). */
#define GSCL_BENCHMARK_CHAINS 10   /* independent chains: more than latency times units of a processor */
#define GSCL_BENCHMARK_LENGTH 4096 /* multiply-adds of each chain */

/* Pixels of a line that a work-item sums windows of, and columns of the walk that a group adds up (cl/placement.cl). */
#define GSCL_BOX_LENGTH 16
#define GSCL_COLUMNS_OF_GROUP 256
#define GSCL_PLACEMENT_DRAWS \
    3 /* random numbers for a splat: of its place in the density, and of the point of its pixel */

#define GSCL_SUM_ITEMS \
    64 /* shares of a sum, and most work-items of a group that sums (cl/group_sum.cl): a power of 2 */

/* Tiles and splats of a part whose losses are summed, and whose low ones are counted, before those of all (cl/sums.cl). */
#define GSCL_CONTROL_PART 1024

/* Taps of the Gaussian window of SSIM along each axis (cl/ssim.cl). */
#define GSCL_SSIM_WINDOW 11
/* Zeros around the planes of cl/ssim.cl, on each side: room for a window and a pixel vector. */
#define GSCL_SSIM_MARGIN 16
/* Squared error in place of MS-SSIM (cl/ssim.cl), found by trying. */
#define GSCL_SSIM_MAX_CONTRAST_GAIN 0.5f /* largest increase of contrast; 1: doubled */
#define GSCL_SSIM_MIN_SIMILARITY 0.1f    /* lower bound of the contrast-structure factor of a window */
#define GSCL_SSIM_WEIGHT_EXPONENT 0.8f   /* on weights without a rendering */

/* Weights of squared errors, in as many planes behind those of the target as the value.  PIXELS: a plane weights all
 * channels.  LUMA: weights and a target of luma, whose weighted squared error is added to that of the channels. */
#define GSCL_WEIGHTED_NOT 0
#define GSCL_WEIGHTED_PIXELS 1
#define GSCL_WEIGHTED_LUMA 2
/* Of red, green and blue in luma: the mean of the responses of two kinds of cones that SSIMULACRA 2 has.  Their sum is 1. */
#define GSCL_LUMA_SHARES 0.265f, 0.657f, 0.078f

/* Sums at one scale of the visual loss (cl/visual.cl): of values and of their 4th powers, for structure, artefacts and
 * lost detail; and of the 6th power of the error. */
#define GSCL_VISUAL_PEAKS 6
#define GSCL_VISUAL_SUMS 7
/* Scales of the visual loss that have terms, at most. */
#define GSCL_VISUAL_TERM_SCALES 3

/* A slot of the fit holds a splat's sums over one tile (cl/fit.cl).  Sums that the effects leave without use have no
 * place in it, so that the later places follow from the shape of splats (GSCL_SHAPE_...) and from what they have. */
#define GSCL_SLOT_U 0
#define GSCL_SLOT_V 1
#define GSCL_SLOT_UU 2
#define GSCL_SLOT_UV 3
#define GSCL_SLOT_VV(shape) (2 + ((shape) != GSCL_SHAPE_ISOTROPIC) + ((shape) == GSCL_SHAPE_ROTATED))
#define GSCL_SLOT_OPACITY(shape) (GSCL_SLOT_VV(shape) + 1)
#define GSCL_SLOT_COLOUR(shape, opacity) (GSCL_SLOT_OPACITY(shape) + (opacity))
#define GSCL_SLOT_WAVE(shape, opacity, channels) (GSCL_SLOT_COLOUR(shape, opacity) + (channels))
/* Floats of a slot. */
#define GSCL_SLOT_SIZE(shape, opacity, channels, texture) (GSCL_SLOT_WAVE(shape, opacity, channels) + (texture))

/* Codebooks of the paper profile (cl/codebook.cl). */
#define GSCL_BOOK_SHAPE 0
#define GSCL_BOOK_COLOUR 1
#define GSCL_BOOKS 2
#define GSCL_BOOK_DIMS 5       /* floats from one word to the next, in either book */
#define GSCL_BOOK_SHAPE_DIMS 3 /* ln s1, ln s2, theta; words of colours have the channels and an opacity logit */

/* A splat's codes in scalar coding (gscl_codes). */
#define GSCL_CODE_MAJOR 0
#define GSCL_CODE_ASPECT 1
#define GSCL_CODE_ANGLE 2
#define GSCL_CODE_X 3
#define GSCL_CODE_Y 4
#define GSCL_CODE_LUMA 5
#define GSCL_CODE_CO 6
#define GSCL_CODE_CG 7
#define GSCL_CODE_ALPHA 8
#define GSCL_CODE_WAVE 9
#define GSCL_CODE_DIRECTION 10
#define GSCL_CODE_PHASE 11
#define GSCL_CODE_AMPLITUDE 12 /* 0: no wave */
#define GSCL_CODE_OPACITY 13
#define GSCL_CODE_COUNT 14

/* Rate-distortion optimisation of scalar codes (cl/scalar_rdo.cl). */
#define GSCL_RDO_MOVES 13        /* moves that are evaluated for a splat */
#define GSCL_RDO_OPACITY_MOVES 2 /* further moves where splats have an opacity */
/* Format: the largest scale code. */
#define GSCL_MAX_SCALE 63
/* Entries of a table over colour codes, which may be negative. */
#define GSCL_COLOUR_CODES 1024

/* Format: a texture's codes. */
#define GSCL_WAVES 16
#define GSCL_DIRECTIONS 16
#define GSCL_DIRECTION_ROWS 8
#define GSCL_PHASES 8
#define GSCL_AMPLITUDES 16
#define GSCL_OPACITIES 16           /* at most */
#define GSCL_FIRST_WAVELENGTH 2.5f  /* pixels: the shortest */
#define GSCL_LARGEST_AMPLITUDE 1.0f /* larger codes saturate */
/* Format: splats with an axis above 2^12 pixels have no wave.  This is ln of an axis between that and the next code's. */
#define GSCL_LOG_LARGEST_WAVED_AXIS 8.328f
#define GSCL_OCTAVES_PER_WAVE 0.4375f /* from one wavelength to the next */

/* The table of bits for rate-distortion optimisation: GSCL_COLOUR_CODES entries each for luma, co, cg and alpha, with
 * code 0 in the middle; then textures; then opacities. */
#define GSCL_BITS_PLAIN (4 * GSCL_COLOUR_CODES)  /* a splat without a wave */
#define GSCL_BITS_TEXTURED (GSCL_BITS_PLAIN + 1) /* a splat with a wave, including the phase */
#define GSCL_BITS_WAVE (GSCL_BITS_PLAIN + 2)
#define GSCL_BITS_DIRECTION (GSCL_BITS_WAVE + GSCL_WAVES)
#define GSCL_BITS_AMPLITUDE (GSCL_BITS_DIRECTION + GSCL_DIRECTIONS) /* of amplitude 1, 2, ... */
#define GSCL_BITS_OPACITY (GSCL_BITS_AMPLITUDE + GSCL_AMPLITUDES)
#define GSCL_BITS_COUNT (GSCL_BITS_OPACITY + GSCL_OPACITIES)

#endif
