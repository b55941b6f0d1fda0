/* The plots of 'gscl tradeoff'. */
#ifndef GSCL_TOOL_TRADEOFF_PLOTS_H
#define GSCL_TOOL_TRADEOFF_PLOTS_H

#include "plot/plot.h"
#include "tradeoff/tradeoff.h"

#define TRADEOFF_PLOTS 4

/* File names without suffix. */
extern const char *const tradeoff_plot_names[TRADEOFF_PLOTS];

/* Fills in plot `number`.  The plan and the results must outlive the plot. */
void tradeoff_plot(const tradeoff_plan *plan, const tradeoff_results *results, int number, plot *p);

#endif
