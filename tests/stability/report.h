/* Rows of the tables in STABILITY.md. */
#ifndef STABILITY_REPORT_H
#define STABILITY_REPORT_H

/* Appends a row to the file that STABILITY_REPORT names, if it is set: subject, case, details, the quantity, its bound
 * and its measured value. */
void report(const char *subject, const char *name, const char *detail, const char *quantity, double bound,
            double measured);

#endif
