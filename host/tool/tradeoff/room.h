/* gscl tradeoff: accuracy and quality against time, as tables, CSV, JSON and plots.
 *
 * It may use: plot/, image/, cli/.
 *
 * In the order in which to read them:
 *   tradeoff.h: the plan and its results
 *   tradeoff_codec.c, tradeoff_accuracy.c: the measurements
 *   tradeoff_tables.h and its sources: the outputs
 *   tradeoff_plots.h, tradeoff_files.h: plots and files */
#ifndef GSCL_ROOM_TOOL_TRADEOFF_H
#define GSCL_ROOM_TOOL_TRADEOFF_H
#endif
