/* Line plots, drawn by a module that wraps cairo.
 *
 * It may use: cli/.
 *
 * In the order in which to read them:
 *   plot.h: panels and series
 *   plot_axis.h, plot_labels.h: axes and labels
 *   plot_cairo.c: the module */
#ifndef GSCL_ROOM_TOOL_PLOT_H
#define GSCL_ROOM_TOOL_PLOT_H
#endif
