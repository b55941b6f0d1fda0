/* Axes of a plot: positions of values on the page, and ticks. */
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
    double from, to;  /* positions of the ends, in points of the page */
    size_t count;     /* of ticks */
    axis_tick ticks[AXIS_MAX_TICKS];
} axis_scale;

/* The scales of a panel whose plot area has these edges.  y grows upwards on the axis and downwards on the page. */
axis_scale axis_of_x(const plot_panel *panel, double left, double right);
axis_scale axis_of_y(const plot_panel *panel, double top, double bottom);

/* Whether the axis can show a value; a logarithmic axis shows positive values only. */
bool axis_shows(const axis_scale *axis, double value);
/* The position of a value on the page, which may be beyond the ends. */
double axis_position(const axis_scale *axis, double value);

#endif
