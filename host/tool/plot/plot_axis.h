/* Axes of a plot: where values lie on the paper, and which of them are written. */
#ifndef GSCL_TOOL_PLOT_AXIS_H
#define GSCL_TOOL_PLOT_AXIS_H

#include "plot/plot.h"

#define AXIS_MAX_TICKS 24

typedef struct axis_tick {
    double value;
    char text[24];
} axis_tick;

typedef struct axis_scale {
    bool is_log;
    double low, high; /* values at the ends */
    double from, to;  /* where they lie, in points of the paper */
    size_t count;     /* of ticks */
    axis_tick ticks[AXIS_MAX_TICKS];
} axis_scale;

/* The scales of a panel whose plot area has these edges; y grows upwards on the axis and downwards on the paper. */
axis_scale axis_of_x(const plot_panel *panel, double left, double right);
axis_scale axis_of_y(const plot_panel *panel, double top, double bottom);

/* A value that the axis cannot show at all: zero on a logarithmic one. */
bool axis_shows(const axis_scale *axis, double value);
/* Where a value lies on the paper, which may be beyond the ends. */
double axis_place(const axis_scale *axis, double value);

#endif
