#include "plot/plot_axis.h"

#include <math.h>
#include <string.h>

#define LINEAR_TICKS 6  /* approximate number */
#define FEW_DECADES 3.0 /* below this, 2 and 5 times the powers of ten have ticks too */
#define SLACK 0.06      /* part of the axis beyond the points */

bool axis_shows(const axis_scale *axis, double value) {
    return !axis->is_log || value > 0;
}

static double to_scale(const axis_scale *axis, double value) {
    return axis->is_log ? log10(value) : value;
}

double axis_position(const axis_scale *axis, double value) {
    const double low = to_scale(axis, axis->low), high = to_scale(axis, axis->high);
    return axis->from + (axis->to - axis->from) * (to_scale(axis, value) - low) / (high - low);
}

/* ---- Ends ---- */

static void include_value(axis_scale *axis, double value) {
    if (!axis_shows(axis, value))
        return;
    axis->low = fmin(axis->low, value);
    axis->high = fmax(axis->high, value);
}

/* Adds space around the points.  Bars start at the bottom, 0 or a power of ten, and leave room for a legend above. */
static void widen_axis(axis_scale *axis, bool bars) {
    if (!(axis->low <= axis->high)) /* no points */
        axis->low = axis->is_log ? 0.1 : 0, axis->high = 1;
    const double low = to_scale(axis, axis->low), high = to_scale(axis, axis->high);
    const double slack = high > low ? SLACK * (high - low) : 0.05 * fabs(high) + 0.05;
    if (axis->is_log) {
        axis->low = bars ? pow(10, floor(low - 0.3)) : pow(10, low - slack);
        axis->high = bars ? pow(10, ceil(high + 0.2 * (high - low))) : pow(10, high + slack);
    } else {
        axis->low = bars ? 0 : low - slack;
        axis->high = bars ? 1.3 * high : high + slack;
    }
}

static bool has_bars(const plot_panel *panel) {
    for (size_t i = 0; i < panel->count; i++)
        if (panel->series[i].style == PLOT_BARS)
            return true;
    return false;
}

/* ---- Ticks ---- */

/* Large and small powers of ten have superscript digits. */
static void write_value(char text[24], double value) {
    static const char *const superscripts[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
    const int power = (int)rint(log10(fabs(value)));
    if (value == 0 || (power >= -3 && power <= 4)) {
        snprintf(text, 24, "%g", value);
        return;
    }
    const int size = power < 0 ? -power : power;
    snprintf(text, 24, "10%s%s%s", power < 0 ? "⁻" : "", size < 10 ? "" : superscripts[size / 10],
             superscripts[size % 10]);
}

static void add_tick(axis_scale *axis, double value) {
    const double low = to_scale(axis, axis->low), high = to_scale(axis, axis->high), tolerance = 1e-9 * (high - low);
    if (!axis->is_log && fabs(value) < tolerance)
        value = 0; /* rounding error of a multiple of the step */
    const double at = to_scale(axis, value);
    if (at < low - tolerance || at > high + tolerance || axis->count == AXIS_MAX_TICKS)
        return;
    axis->ticks[axis->count].value = value;
    write_value(axis->ticks[axis->count++].text, value);
}

static void add_linear_ticks(axis_scale *axis) {
    const double rough = (axis->high - axis->low) / LINEAR_TICKS, power = pow(10, floor(log10(rough)));
    const double step = rough / power < 1.5 ? power : rough / power < 3.5 ? 2 * power : 5 * power;
    const double first = ceil(axis->low / step - 1e-9);
    for (int i = 0; (first + i) * step <= axis->high * (1 + 1e-9); i++)
        add_tick(axis, (first + i) * step);
}

static void add_log_ticks(axis_scale *axis) {
    const double decades = log10(axis->high / axis->low);
    const int stride = decades > 9 ? 2 : 1, first = (int)floor(log10(axis->low));
    for (int power = first; power <= (int)ceil(log10(axis->high)); power++) {
        if (power % stride == 0)
            add_tick(axis, pow(10, power));
        for (int digit = 2; digit <= 5 && decades < FEW_DECADES; digit += 3)
            add_tick(axis, digit * pow(10, power));
    }
}

static axis_scale finish_axis(axis_scale axis, const plot_axis *settings, bool bars) {
    if (settings->low < settings->high) {
        axis.low = settings->low;
        axis.high = settings->high;
    } else {
        widen_axis(&axis, bars);
    }
    if (axis.is_log)
        add_log_ticks(&axis);
    else
        add_linear_ticks(&axis);
    return axis;
}

axis_scale axis_of_x(const plot_panel *panel, double left, double right) {
    axis_scale axis = {.is_log = panel->x.is_log, .low = INFINITY, .high = -INFINITY, .from = left, .to = right};
    if (panel->category_count > 0) {
        axis.low = -0.5;
        axis.high = (double)panel->category_count - 0.5;
        return axis; /* categories have names instead of ticks */
    }
    for (size_t i = 0; i < panel->count; i++)
        for (size_t k = 0; k < panel->series[i].count; k++)
            if (panel->series[i].style != PLOT_FAINT)
                include_value(&axis, panel->series[i].points[k].x);
    return finish_axis(axis, &panel->x, false);
}

axis_scale axis_of_y(const plot_panel *panel, double top, double bottom) {
    axis_scale axis = {.is_log = panel->y.is_log, .low = INFINITY, .high = -INFINITY, .from = bottom, .to = top};
    if (panel->guide > 0)
        include_value(&axis, panel->guide);
    for (size_t i = 0; i < panel->count; i++)
        for (size_t k = 0; k < panel->series[i].count; k++)
            include_value(&axis, panel->series[i].points[k].y);
    return finish_axis(axis, &panel->y, has_bars(panel));
}
