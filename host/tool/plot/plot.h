/* The contents of a plot: panels with axes and series of points.  A module draws it.  Texts are not copied and must live as
 * long as the plot. */
#ifndef GSCL_TOOL_PLOT_H
#define GSCL_TOOL_PLOT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "host/system/printf_format.h"

#define PLOT_MAX_PANELS 4
#define PLOT_MAX_SERIES 24
#define PLOT_MAX_POINTS 96
#define PLOT_MAX_CATEGORIES 12
#define PLOT_LABEL_SIZE 64 /* bytes */

typedef enum plot_style {
    PLOT_FAINT,  /* a thin line behind all others, without points */
    PLOT_POINTS, /* labelled points and a line through them */
    PLOT_DASHED, /* smaller points without labels, and a dashed line */
    PLOT_BARS    /* from the bottom of the panel, beside those of other series */
} plot_style;

typedef enum plot_colour {
    PLOT_GREY,
    PLOT_BLUE,
    PLOT_ORANGE,
    PLOT_GREEN,
    PLOT_PURPLE,
} plot_colour;

typedef struct plot_point {
    double x, y; /* x of a category: its number from 0 */
    char label[PLOT_LABEL_SIZE];
    bool is_default; /* drawn with a ring */
} plot_point;

typedef struct plot_series {
    char name[PLOT_LABEL_SIZE]; /* in the legend; empty: not in the legend */
    plot_style style;
    plot_colour colour;
    size_t count;
    plot_point points[PLOT_MAX_POINTS];
} plot_series;

typedef struct plot_axis {
    const char *title; /* with the unit */
    bool is_log;
    double low, high; /* ends; both 0: chosen for the points */
} plot_axis;

typedef struct plot_panel {
    const char *title;
    plot_axis x, y;
    const char *categories[PLOT_MAX_CATEGORIES]; /* along x */
    size_t category_count;                       /* 0: x is a number */
    double guide;                                /* a horizontal line; 0: none */
    const char *guide_label;
    size_t count;
    plot_series series[PLOT_MAX_SERIES];
} plot_panel;

typedef struct plot {
    const char *title, *subtitle;
    size_t columns; /* of panels */
    size_t count;
    plot_panel panels[PLOT_MAX_PANELS];
} plot;

/* All of these drop what exceeds the capacity. */
plot_panel *plot_add_panel(plot *p, const char *title, const char *x_title, const char *y_title);
plot_series *plot_add_series(plot_panel *panel, const char *name, plot_style style, plot_colour colour);
/* `label` is a format as of printf.  Points that are not finite (on a logarithmic axis: not positive) are dropped. */
GSCL_PRINTF(5, 6)
void plot_add_point(plot_series *series, double x, double y, bool is_default, const char *label, ...);
/* The number of a category, which is added if it is new. */
double plot_category(plot_panel *panel, const char *name);

/* ---- The module, which links cairo ---- */

#define PLOT_MODULE_FILE "gscl-plot.so"
#define PLOT_MODULE_SYMBOL "gscl_plot_module" /* of type plot_module */

typedef enum plot_format { PLOT_SVG, PLOT_PNG } plot_format;

typedef struct plot_module {
    /* Draws into a stream.  Returns false when out of memory, or when the stream failed (see ferror). */
    bool (*draw)(const plot *p, plot_format format, FILE *stream);
} plot_module;

#endif
