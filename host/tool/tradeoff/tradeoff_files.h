/* The files of 'gscl tradeoff' in its folder: either all are written or none. */
#ifndef GSCL_TOOL_TRADEOFF_FILES_H
#define GSCL_TOOL_TRADEOFF_FILES_H

#include "cli/output_file.h"
#include "plot/plot.h"
#include "tradeoff/tradeoff.h"
#include "tradeoff/tradeoff_plots.h"

#define TRADEOFF_TABLES 6 /* five of CSV, one of JSON */
#define TRADEOFF_FILES (TRADEOFF_TABLES + 2 * TRADEOFF_PLOTS)

typedef struct tradeoff_files {
    const char *folder;
    bool made_folder;
    const plot_module *module; /* NULL: no plots */
    size_t count;              /* of files that are open */
    char *names[TRADEOFF_FILES];
    output_file outputs[TRADEOFF_FILES];
} tradeoff_files;

/* Makes the folder if it is missing, and opens all files.  Reports errors.  A missing plot module is only noted: the
 * tables are written without plots. */
bool tradeoff_files_open(tradeoff_files *files, const char *folder);

/* Writes and finishes all files.  Reports errors.  The files are closed in any case. */
bool tradeoff_files_write(tradeoff_files *files, const tradeoff_plan *plan, const tradeoff_results *results);

/* Removes all unfinished files, and the folder if it is new. */
void tradeoff_files_discard(tradeoff_files *files);

#endif
