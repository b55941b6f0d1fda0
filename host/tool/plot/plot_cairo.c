/* The module that draws plots with cairo, as SVG or as PNG. */
#include <math.h>
#include <string.h>

#include <cairo-svg.h>
#include <cairo.h>

#include "plot/plot.h"
#include "plot/plot_axis.h"
#include "plot/plot_labels.h"

/* Lengths in points of the page. */
#define PANEL_WIDTH 480.0
#define PANEL_HEIGHT 338.0
#define LEFT 62.0 /* from a panel's edge to its axes */
#define RIGHT 18.0
#define TOP 30.0
#define BOTTOM 58.0
#define HEAD 52.0 /* title and subtitle */
#define PNG_SCALE 2.0
#define TEXT 11.0
#define RADIUS 3.6
#define BAR_SHARE 0.78   /* of a category's width */
#define FEW_CATEGORIES 5 /* their names fit side by side */

static const double colours[][3] = {
    [PLOT_GREY] = {0.72, 0.72, 0.74},  [PLOT_BLUE] = {0.00, 0.37, 0.66},   [PLOT_ORANGE] = {0.86, 0.42, 0.00},
    [PLOT_GREEN] = {0.00, 0.55, 0.40}, [PLOT_PURPLE] = {0.62, 0.28, 0.56},
};

/* The state of drawing a panel. */
typedef struct canvas {
    cairo_t *cairo;
    const plot_panel *panel;
    double left, right, top, bottom; /* of the area inside the axes */
    axis_scale x, y;
    label_map labels;
} canvas;

static void set_grey(cairo_t *cairo, double level) {
    cairo_set_source_rgb(cairo, level, level, level);
}

static void set_colour(cairo_t *cairo, plot_colour colour) {
    cairo_set_source_rgb(cairo, colours[colour][0], colours[colour][1], colours[colour][2]);
}

static void set_font(cairo_t *cairo, double size, bool bold) {
    cairo_select_font_face(cairo, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                           bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cairo, size);
}

static double text_width(cairo_t *cairo, const char *text) {
    cairo_text_extents_t extents;
    cairo_text_extents(cairo, text, &extents);
    return extents.x_advance;
}

/* `share` is the part of the text left of x; y is its baseline. */
static void show_text(cairo_t *cairo, double x, double y, double share, const char *text) {
    cairo_move_to(cairo, x - share * text_width(cairo, text), y);
    cairo_show_text(cairo, text);
}

static void draw_segment(cairo_t *cairo, double x0, double y0, double x1, double y1) {
    cairo_move_to(cairo, x0, y0);
    cairo_line_to(cairo, x1, y1);
    cairo_stroke(cairo);
}

/* ---- Axes ---- */

static void draw_x_ticks(canvas *c) {
    for (size_t i = 0; i < c->x.count; i++) {
        const double x = axis_position(&c->x, c->x.ticks[i].value);
        set_grey(c->cairo, 0.9);
        draw_segment(c->cairo, x, c->top, x, c->bottom);
        set_grey(c->cairo, 0.25);
        show_text(c->cairo, x, c->bottom + 16, 0.5, c->x.ticks[i].text);
    }
}

/* Draws the names of categories, every second one lower where there are many. */
static void draw_categories(canvas *c) {
    const size_t count = c->panel->category_count;
    set_grey(c->cairo, 0.25);
    for (size_t i = 0; i < count; i++) {
        const double offset = count > FEW_CATEGORIES && i % 2 == 1 ? 13 : 0;
        show_text(c->cairo, axis_position(&c->x, (double)i), c->bottom + 16 + offset, 0.5, c->panel->categories[i]);
    }
}

static void draw_y_ticks(canvas *c) {
    for (size_t i = 0; i < c->y.count; i++) {
        const double y = axis_position(&c->y, c->y.ticks[i].value);
        set_grey(c->cairo, 0.9);
        draw_segment(c->cairo, c->left, y, c->right, y);
        set_grey(c->cairo, 0.25);
        show_text(c->cairo, c->left - 7, y + 4, 1, c->y.ticks[i].text);
    }
}

static void draw_axis_titles(canvas *c) {
    set_grey(c->cairo, 0.25);
    show_text(c->cairo, (c->left + c->right) / 2, c->bottom + (c->panel->category_count > FEW_CATEGORIES ? 47 : 36),
              0.5, c->panel->x.title);
    cairo_save(c->cairo);
    cairo_translate(c->cairo, c->left - LEFT + 13, (c->top + c->bottom) / 2);
    cairo_rotate(c->cairo, -1.5707963267948966);
    show_text(c->cairo, 0, 0, 0.5, c->panel->y.title);
    cairo_restore(c->cairo);
    set_font(c->cairo, 13, true);
    set_grey(c->cairo, 0.1);
    show_text(c->cairo, c->left, c->top - 10, 0, c->panel->title);
    set_font(c->cairo, TEXT, false);
}

static void draw_axes(canvas *c) {
    set_font(c->cairo, TEXT, false);
    cairo_set_line_width(c->cairo, 1);
    draw_x_ticks(c);
    draw_categories(c);
    draw_y_ticks(c);
    draw_axis_titles(c);
    set_grey(c->cairo, 0.45);
    draw_segment(c->cairo, c->left, c->bottom, c->right, c->bottom);
    draw_segment(c->cairo, c->left, c->top, c->left, c->bottom);
}

static void draw_guide(canvas *c) {
    const double dashes[] = {5, 3};
    if (!(c->panel->guide > 0))
        return;
    const double y = axis_position(&c->y, c->panel->guide), width = text_width(c->cairo, c->panel->guide_label);
    cairo_set_dash(c->cairo, dashes, 2, 0);
    set_grey(c->cairo, 0.45);
    draw_segment(c->cairo, c->left, y, c->right, y);
    cairo_set_dash(c->cairo, NULL, 0, 0);
    show_text(c->cairo, c->right - 4, y - 4, 1, c->panel->guide_label);
    labels_add(&c->labels, (label_box){c->right - 4 - width, y - 15, width, 15}, 60);
}

/* ---- Series ---- */

static bool is_shown(const canvas *c, const plot_point *point) {
    return axis_shows(&c->x, point->x) && axis_shows(&c->y, point->y);
}

static void set_line(cairo_t *cairo, plot_style style) {
    const double dashes[] = {4, 3};
    cairo_set_line_width(cairo, style == PLOT_POINTS ? 1.6 : 1.1);
    cairo_set_dash(cairo, dashes, style == PLOT_DASHED ? 2 : 0, 0);
}

/* Draws the line of a series, clipped to the area inside the axes. */
static void draw_line(canvas *c, const plot_series *s) {
    double x = 0, y = 0;
    bool has_start = false;
    cairo_save(c->cairo);
    cairo_rectangle(c->cairo, c->left, c->top, c->right - c->left, c->bottom - c->top);
    cairo_clip(c->cairo);
    set_colour(c->cairo, s->colour);
    set_line(c->cairo, s->style);
    for (size_t i = 0; i < s->count; i++) {
        if (!is_shown(c, &s->points[i]))
            continue;
        const double to_x = axis_position(&c->x, s->points[i].x), to_y = axis_position(&c->y, s->points[i].y);
        cairo_line_to(c->cairo, to_x, to_y);
        if (has_start)
            labels_add_line(&c->labels, x, y, to_x, to_y, s->style == PLOT_FAINT ? 1 : 4);
        has_start = true;
        x = to_x;
        y = to_y;
    }
    cairo_stroke(c->cairo);
    cairo_restore(c->cairo);
}

static void draw_dots(canvas *c, const plot_series *s) {
    const double radius = s->style == PLOT_DASHED ? 0.7 * RADIUS : RADIUS;
    for (size_t i = 0; i < s->count; i++) {
        if (!is_shown(c, &s->points[i]))
            continue;
        const double x = axis_position(&c->x, s->points[i].x), y = axis_position(&c->y, s->points[i].y);
        set_colour(c->cairo, s->colour);
        cairo_arc(c->cairo, x, y, radius, 0, 6.283185307179586);
        cairo_fill(c->cairo);
        if (s->points[i].is_default) {
            cairo_set_line_width(c->cairo, 1.6);
            cairo_arc(c->cairo, x, y, radius + 3, 0, 6.283185307179586);
            cairo_stroke(c->cairo);
        }
        labels_add(&c->labels, (label_box){x - radius - 1, y - radius - 1, 2 * radius + 2, 2 * radius + 2}, 30);
    }
}

/* Draws the bars of a series, number `at` of `count` bars that stand side by side in each category. */
static void draw_bars(canvas *c, const plot_series *s, size_t at, size_t count) {
    const double unit = (c->right - c->left) / (double)c->panel->category_count,
                 width = BAR_SHARE * unit / (double)count;
    set_colour(c->cairo, s->colour);
    for (size_t i = 0; i < s->count; i++) {
        if (!is_shown(c, &s->points[i]))
            continue;
        const double x = axis_position(&c->x, s->points[i].x) + ((double)at - 0.5 * (double)count) * width;
        const double y = axis_position(&c->y, s->points[i].y);
        cairo_rectangle(c->cairo, x + 0.5, y, width - 1, c->bottom - y);
        cairo_fill(c->cairo);
        labels_add(&c->labels, (label_box){x, y, width, c->bottom - y}, 30);
    }
}

static void draw_all_bars(canvas *c) {
    size_t count = 0, at = 0;
    for (size_t i = 0; i < c->panel->count; i++)
        count += c->panel->series[i].style == PLOT_BARS;
    for (size_t i = 0; i < c->panel->count; i++)
        if (c->panel->series[i].style == PLOT_BARS)
            draw_bars(c, &c->panel->series[i], at++, count);
}

static void draw_series(canvas *c) {
    const plot_panel *panel = c->panel;
    draw_all_bars(c);
    for (size_t i = 0; i < panel->count; i++)
        if (panel->series[i].style != PLOT_BARS)
            draw_line(c, &panel->series[i]);
    for (size_t i = 0; i < panel->count; i++)
        if (panel->series[i].style == PLOT_POINTS || panel->series[i].style == PLOT_DASHED)
            draw_dots(c, &panel->series[i]);
}

/* ---- Texts over the series ---- */

/* Draws a translucent white backdrop for a text. */
static void draw_backdrop(canvas *c, label_box box) {
    cairo_rectangle(c->cairo, box.x, box.y, box.width, box.height);
    cairo_set_source_rgba(c->cairo, 1, 1, 1, 0.75);
    cairo_fill(c->cairo);
}

static void draw_labels(canvas *c, const plot_series *s) {
    for (size_t i = 0; i < s->count; i++) {
        const plot_point *point = &s->points[i];
        if (!is_shown(c, point) || strcmp(point->label, " ") == 0)
            continue;
        set_font(c->cairo, 10, point->is_default);
        const double radius = RADIUS + (point->is_default ? 3 : 0);
        const label_box box = labels_place(&c->labels, axis_position(&c->x, point->x), axis_position(&c->y, point->y),
                                           radius, text_width(c->cairo, point->label), 12);
        draw_backdrop(c, box);
        set_colour(c->cairo, s->colour);
        show_text(c->cairo, box.x, box.y + box.height - 3, 0, point->label);
    }
    set_font(c->cairo, TEXT, false);
}

static void draw_legend_mark(canvas *c, const plot_series *s, double x, double y) {
    set_colour(c->cairo, s->colour);
    if (s->style == PLOT_BARS) {
        cairo_rectangle(c->cairo, x + 4, y - 4, 9, 9);
        cairo_fill(c->cairo);
        return;
    }
    set_line(c->cairo, s->style);
    draw_segment(c->cairo, x, y, x + 18, y);
    cairo_set_dash(c->cairo, NULL, 0, 0);
    if (s->style == PLOT_FAINT)
        return;
    cairo_arc(c->cairo, x + 9, y, s->style == PLOT_DASHED ? 0.7 * RADIUS : RADIUS, 0, 6.283185307179586);
    cairo_fill(c->cairo);
}

static void draw_legend(canvas *c) {
    double width = 0, rows = 0;
    for (size_t i = 0; i < c->panel->count; i++) {
        if (!c->panel->series[i].name[0] || c->panel->series[i].count == 0)
            continue;
        width = fmax(width, text_width(c->cairo, c->panel->series[i].name));
        rows++;
    }
    if (rows == 0)
        return;
    const label_box box = labels_place_in_corner(&c->labels, width + 36, 15 * rows + 6);
    draw_backdrop(c, box);
    double y = box.y + 11;
    for (int faint = 0; faint < 2; faint++) /* faint series come last */
        for (size_t i = 0; i < c->panel->count; i++) {
            const plot_series *s = &c->panel->series[i];
            if (!s->name[0] || s->count == 0 || (s->style == PLOT_FAINT) != faint)
                continue;
            draw_legend_mark(c, s, box.x + 5, y);
            set_grey(c->cairo, 0.15);
            show_text(c->cairo, box.x + 29, y + 4, 0, s->name);
            y += 15;
        }
}

/* ---- The whole ---- */

static void draw_panel(cairo_t *cairo, const plot_panel *panel, double x, double y) {
    canvas c = {.cairo = cairo,
                .panel = panel,
                .left = x + LEFT,
                .right = x + PANEL_WIDTH - RIGHT,
                .top = y + TOP,
                .bottom = y + PANEL_HEIGHT - BOTTOM};
    c.x = axis_of_x(panel, c.left, c.right);
    c.y = axis_of_y(panel, c.top, c.bottom);
    c.labels.inside = (label_box){c.left, c.top, c.right - c.left, c.bottom - c.top};
    draw_axes(&c);
    draw_guide(&c);
    draw_series(&c);
    draw_legend(&c);
    for (size_t i = 0; i < panel->count; i++)
        if (panel->series[i].style == PLOT_POINTS)
            draw_labels(&c, &panel->series[i]);
}

static void draw_plot(cairo_t *cairo, const plot *p) {
    cairo_set_source_rgb(cairo, 1, 1, 1);
    cairo_paint(cairo);
    set_font(cairo, 16, true);
    set_grey(cairo, 0.1);
    show_text(cairo, 16, 24, 0, p->title);
    set_font(cairo, 10, false);
    set_grey(cairo, 0.4);
    show_text(cairo, 16, 41, 0, p->subtitle);
    for (size_t i = 0; i < p->count; i++)
        draw_panel(cairo, &p->panels[i], (double)(i % p->columns) * PANEL_WIDTH,
                   HEAD + (double)(i / p->columns) * PANEL_HEIGHT);
}

static cairo_status_t write_bytes(void *stream, const unsigned char *bytes, unsigned int size) {
    return fwrite(bytes, 1, size, stream) == size ? CAIRO_STATUS_SUCCESS : CAIRO_STATUS_WRITE_ERROR;
}

static bool draw(const plot *p, plot_format format, FILE *stream) {
    const double width = PANEL_WIDTH * (double)p->columns;
    const double height = HEAD + PANEL_HEIGHT * (double)((p->count + p->columns - 1) / p->columns);
    cairo_surface_t *surface =
        format == PLOT_SVG
            ? cairo_svg_surface_create_for_stream(write_bytes, stream, width, height)
            : cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)(PNG_SCALE * width), (int)(PNG_SCALE * height));
    cairo_t *cairo = cairo_create(surface);
    if (format == PLOT_PNG)
        cairo_scale(cairo, PNG_SCALE, PNG_SCALE);
    draw_plot(cairo, p);
    cairo_status_t status = cairo_status(cairo);
    cairo_destroy(cairo);
    if (format == PLOT_PNG && status == CAIRO_STATUS_SUCCESS)
        status = cairo_surface_write_to_png_stream(surface, write_bytes, stream);
    cairo_surface_finish(surface);
    if (status == CAIRO_STATUS_SUCCESS)
        status = cairo_surface_status(surface);
    cairo_surface_destroy(surface);
    return status == CAIRO_STATUS_SUCCESS;
}

__attribute__((visibility("default"))) extern const plot_module gscl_plot_module;
const plot_module gscl_plot_module = {draw};
