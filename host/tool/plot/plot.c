#include "plot/plot.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

plot_panel *plot_add_panel(plot *p, const char *title, const char *x_title, const char *y_title) {
    plot_panel *panel = &p->panels[p->count < PLOT_MAX_PANELS ? p->count++ : PLOT_MAX_PANELS - 1];
    panel->title = title;
    panel->x.title = x_title;
    panel->y.title = y_title;
    return panel;
}

plot_series *plot_add_series(plot_panel *panel, const char *name, plot_style style, plot_colour colour) {
    plot_series *series = &panel->series[panel->count < PLOT_MAX_SERIES ? panel->count++ : PLOT_MAX_SERIES - 1];
    snprintf(series->name, sizeof series->name, "%s", name);
    series->style = style;
    series->colour = colour;
    return series;
}

void plot_add_point(plot_series *series, double x, double y, bool is_default, const char *label, ...) {
    if (!isfinite(x) || !isfinite(y) || series->count == PLOT_MAX_POINTS)
        return;
    plot_point *point = &series->points[series->count++];
    point->x = x;
    point->y = y;
    point->is_default = is_default;
    va_list arguments;
    va_start(arguments, label);
    vsnprintf(point->label, sizeof point->label, label, arguments);
    va_end(arguments);
}

double plot_category(plot_panel *panel, const char *name) {
    for (size_t i = 0; i < panel->category_count; i++)
        if (strcmp(panel->categories[i], name) == 0)
            return (double)i;
    if (panel->category_count == PLOT_MAX_CATEGORIES)
        return NAN; /* drops the point */
    panel->categories[panel->category_count] = name;
    return (double)panel->category_count++;
}
