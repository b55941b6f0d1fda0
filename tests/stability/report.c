#include "report.h"

#include <stdio.h>
#include <stdlib.h>

void report(const char *subject, const char *name, const char *detail, const char *quantity, double bound,
            double measured) {
    const char *path = getenv("STABILITY_REPORT");
    FILE *file = path ? fopen(path, "a") : NULL;
    if (!file)
        return;
    fprintf(file, "%s|%s|%s|%s|%.3g|%.3g\n", subject, name, detail, quantity, bound, measured);
    fclose(file);
}
