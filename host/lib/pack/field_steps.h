/* The steps of the quantiser that a field is stored with, and its splats as codes. */
#ifndef GSCL_LIB_FIELD_STEPS_H
#define GSCL_LIB_FIELD_STEPS_H

#include "pack/pack_state.h"

/* The number of sets of steps, from 0, the finest that the format has, or those of the field where it has steps, to the coarsest. */
int gscl_pack_step_sets(const gscl_packing *packing);
/* The steps of such a set for the splats of the packing. */
gsf_steps gscl_pack_steps(const gscl_packing *packing, int set);

/* Whether the splats of a field with steps are codes of these: those of a file that have not been changed. */
bool gscl_pack_has_codes(gscl_packing *packing);

/* Puts the stored splats of a field of the blend alpha into the order that the format has for them with these steps, and counts in
 * the report those that have another place. */
gscl_result gscl_pack_take_order(gscl_packing *packing, const gsf_steps *steps);

/* packing->coded becomes the stored splats in codes of these steps, in the stored order; *size is that of the picture. */
gscl_result gscl_pack_quantise(gscl_packing *packing, const gsf_steps *steps, size_t *size);
/* The same, and notes the largest errors in the report. */
gscl_result gscl_pack_quantise_measured(gscl_packing *packing, const gsf_steps *steps, size_t *size);

/* The first set, of increasing coarseness, with which the picture has at most `bytes`; where none has, *set is the number of sets
 * and *size that of the coarsest. */
gscl_result gscl_pack_find_steps(gscl_packing *packing, double bytes, int *set, size_t *size);

#endif
