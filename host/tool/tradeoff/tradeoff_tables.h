/* The tables of 'gscl tradeoff': on the terminal, as CSV and as JSON. */
#ifndef GSCL_TOOL_TRADEOFF_TABLES_H
#define GSCL_TOOL_TRADEOFF_TABLES_H

#include <stdio.h>

#include "tradeoff/tradeoff.h"

void tradeoff_print(const tradeoff_plan *plan, const tradeoff_results *results);

void tradeoff_write_json(const tradeoff_plan *plan, const tradeoff_results *results, FILE *stream);

/* CSV with a line of column names.  A cell is empty where the column does not apply. */
void tradeoff_write_efforts(const tradeoff_plan *plan, const tradeoff_results *results, FILE *stream);
void tradeoff_write_trace(const tradeoff_plan *plan, const tradeoff_results *results, FILE *stream);
void tradeoff_write_rates(const tradeoff_plan *plan, const tradeoff_results *results, FILE *stream);
void tradeoff_write_accuracies(const tradeoff_plan *plan, const tradeoff_results *results, FILE *stream);
void tradeoff_write_gradients(const tradeoff_plan *plan, const tradeoff_results *results, FILE *stream);

#endif
