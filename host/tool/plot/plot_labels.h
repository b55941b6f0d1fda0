/* Positions of the texts of a panel, such that they overlap as little as possible with each other and with the series. */
#ifndef GSCL_TOOL_PLOT_LABELS_H
#define GSCL_TOOL_PLOT_LABELS_H

#include <stdbool.h>
#include <stddef.h>

#define LABELS_MAX_OBSTACLES 1024

/* In points of the page, y downwards. */
typedef struct label_box {
    double x, y, width, height;
} label_box;

typedef struct label_map {
    label_box inside; /* area for texts */
    size_t count;
    struct {
        label_box box;
        double weight; /* cost of covering all of it */
    } obstacles[LABELS_MAX_OBSTACLES];
} label_map;

/* Adds an obstacle. */
void labels_add(label_map *map, label_box box, double weight);
/* Adds small obstacles along a line. */
void labels_add_line(label_map *map, double x0, double y0, double x1, double y1, double weight);
/* The cost of a text in this box. */
double labels_cost(const label_map *map, label_box box);
/* The best box for a text of this size beside a point whose mark has this radius.  The box becomes an obstacle. */
label_box labels_place(label_map *map, double x, double y, double radius, double width, double height);
/* The best corner for a text of this size.  Its box becomes an obstacle. */
label_box labels_place_in_corner(label_map *map, double width, double height);

#endif
