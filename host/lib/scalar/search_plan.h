/* Levels and rounds of a search (search.h).  Levels are counted from the source's, which has `source_pixels` pixels. */
#ifndef GSCL_LIB_SEARCH_PLAN_H
#define GSCL_LIB_SEARCH_PLAN_H

#include <stdbool.h>
#include <stddef.h>

/* The level at which `splats` splats are searched. */
int gscl_search_level(double source_pixels, size_t splats);
/* The level of the last part of a search at `level`.  That of waves has those that are too fine for the others. */
int gscl_search_final_level(double source_pixels, int level, bool waves);
/* The rounds of an effort whose preset has `rounds`: fewer at a level at which a round takes longer. */
int gscl_search_rounds(double source_pixels, int level, int rounds);

#endif
