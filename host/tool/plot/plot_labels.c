#include "plot/plot_labels.h"

#include <math.h>

#define LINE_STEP 6.0 /* points between the boxes along a line */
#define TEXT_WEIGHT 40.0
#define OUTSIDE_WEIGHT 400.0
#define DISTANCE_WEIGHT 0.03 /* per point of the page between text and mark */
#define RINGS 4              /* distances that are tried */
#define DIRECTIONS 16        /* directions that are tried */

void labels_add(label_map *map, label_box box, double weight) {
    if (map->count == LABELS_MAX_OBSTACLES)
        return;
    map->obstacles[map->count].box = box;
    map->obstacles[map->count++].weight = weight;
}

void labels_add_line(label_map *map, double x0, double y0, double x1, double y1, double weight) {
    const double length = hypot(x1 - x0, y1 - y0);
    for (int i = 0; (i + 0.5) * LINE_STEP < length; i++) {
        const double at = (i + 0.5) * LINE_STEP / length;
        labels_add(map, (label_box){x0 + (x1 - x0) * at - 1, y0 + (y1 - y0) * at - 1, 2, 2}, weight);
    }
}

static double overlap(double a, double a_size, double b, double b_size) {
    return fmax(fmin(a + a_size, b + b_size) - fmax(a, b), 0);
}

static double common_area(label_box a, label_box b) {
    return overlap(a.x, a.width, b.x, b.width) * overlap(a.y, a.height, b.y, b.height);
}

double labels_cost(const label_map *map, label_box box) {
    const double area = box.width * box.height;
    double cost = OUTSIDE_WEIGHT * (1 - common_area(map->inside, box) / area);
    for (size_t i = 0; i < map->count; i++) {
        const label_box other = map->obstacles[i].box;
        cost += map->obstacles[i].weight * common_area(other, box) / fmin(area, other.width * other.height);
    }
    return cost;
}

static label_box add_best(label_map *map, label_box best) {
    labels_add(map, best, TEXT_WEIGHT);
    return best;
}

/* Offset of a box from a point in direction `cosine`: before, around or after it. */
static double box_offset(double cosine, double size) {
    return cosine > 0.3 ? 0 : cosine < -0.3 ? -size : -size / 2;
}

/* A box that touches a circle of radius `gap` around the point. */
static label_box box_beside(double x, double y, double gap, double angle, double width, double height) {
    const double c = cos(angle), s = -sin(angle);
    return (label_box){x + gap * c + box_offset(c, width), y + gap * s + box_offset(s, height), width, height};
}

label_box labels_place(label_map *map, double x, double y, double radius, double width, double height) {
    label_box best = {x, y, width, height};
    double lowest = INFINITY;
    for (int ring = 0; ring < RINGS; ring++)
        for (int i = 0; i < DIRECTIONS; i++) {
            const double angle = i * 2 * 3.14159265358979 / DIRECTIONS, gap = radius + 3 + 6 * ring;
            const label_box box = box_beside(x, y, gap, angle, width, height);
            const double cost = labels_cost(map, box) + DISTANCE_WEIGHT * gap;
            if (cost < lowest - 1e-9) {
                lowest = cost;
                best = box;
            }
        }
    return add_best(map, best);
}

label_box labels_place_in_corner(label_map *map, double width, double height) {
    const label_box in = map->inside;
    label_box best = {in.x, in.y, width, height};
    double lowest = INFINITY;
    for (int corner = 0; corner < 6; corner++) {
        static const double across[] = {1, 0, 1, 0, 0.5, 0.5}, down[] = {1, 0, 0, 1, 0, 1};
        const label_box box = {in.x + 6 + across[corner] * (in.width - width - 12),
                               in.y + 6 + down[corner] * (in.height - height - 12), width, height};
        const double cost = labels_cost(map, box);
        if (cost < lowest - 1e-9) {
            lowest = cost;
            best = box;
        }
    }
    return add_best(map, best);
}
