/* What the page STABILITY.md is made of. */
#ifndef STABILITY_REPORT_H
#define STABILITY_REPORT_H

/* A row: subject, case, details, what is measured, its bound and how large it was.  Goes into the file that
 * STABILITY_REPORT names; nowhere without. */
void report(const char *subject, const char *name, const char *detail, const char *what, double bound, double measured);

#endif
