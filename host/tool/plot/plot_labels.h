/* Where the texts of a panel go, so that they cover neither each other nor what they name. */
#ifndef GSCL_TOOL_PLOT_LABELS_H
#define GSCL_TOOL_PLOT_LABELS_H

#include <stdbool.h>
#include <stddef.h>

#define LABELS_MAX_OBSTACLES 1024

/* In points of the paper, y downwards. */
typedef struct label_box {
    double x, y, width, height;
} label_box;

typedef struct label_map {
    label_box inside; /* what a text must not leave */
    size_t count;
    struct {
        label_box box;
        double weight; /* how bad it is to cover all of it */
    } obstacles[LABELS_MAX_OBSTACLES];
} label_map;

void labels_add(label_map *map, label_box box, double weight);
/* Small boxes along a line. */
void labels_add_line(label_map *map, double x0, double y0, double x1, double y1, double weight);
/* How much a text in this box would cover. */
double labels_cost(const label_map *map, label_box box);
/* The best place for a text of this size beside a point whose mark has this radius; it becomes an obstacle. */
label_box labels_place(label_map *map, double x, double y, double radius, double width, double height);
/* The best corner for a text of this size; it becomes an obstacle. */
label_box labels_place_in_corner(label_map *map, double width, double height);

#endif
