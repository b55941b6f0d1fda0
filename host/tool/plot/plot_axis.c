#include "plot/plot_axis.h"

#include <math.h>
#include <string.h>

#define LINEAR_TICKS 6  /* about */
#define FEW_DECADES 3.0 /* with so few, numbers between the powers of ten are written, too */
#define SLACK 0.06      /* of the axis, beyond the points */

bool axis_shows(const axis_scale *axis, double value) {
    return !axis->is_log || value > 0;
}

static double scaled(const axis_scale *axis, double value) {
    return axis->is_log ? log10(value) : value;
}

double axis_place(const axis_scale *axis, double value) {
    const double low = scaled(axis, axis->low), high = scaled(axis, axis->high);
    return axis->from + (axis->to - axis->from) * (scaled(axis, value) - low) / (high - low);
}

/* ---- Ends ---- */

static void include(axis_scale *axis, double value) {
    if (!axis_shows(axis, value))
        return;
    axis->low = fmin(axis->low, value);
    axis->high = fmax(axis->high, value);
}

/* Space around the points; bars stand on the bottom, 0 or a power of ten, and leave room for a legend above. */
static void widen(axis_scale *axis, bool bars) {
    if (!(axis->low <= axis->high)) /* no point at all */
        axis->low = axis->is_log ? 0.1 : 0, axis->high = 1;
    const double low = scaled(axis, axis->low), high = scaled(axis, axis->high);
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

/* Powers of ten that would be long are written with raised digits. */
static void write_value(char text[24], double value) {
    static const char *const raised[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
    const int power = (int)rint(log10(fabs(value)));
    if (value == 0 || (power >= -3 && power <= 4)) {
        snprintf(text, 24, "%g", value);
        return;
    }
    snprintf(text, 24, "10%s", power < 0 ? "⁻" : "");
    const int size = power < 0 ? -power : power;
    if (size >= 10)
        strcat(text, raised[size / 10]);
    strcat(text, raised[size % 10]);
}

static void add_tick(axis_scale *axis, double value) {
    const double low = scaled(axis, axis->low), high = scaled(axis, axis->high), tolerance = 1e-9 * (high - low);
    if (!axis->is_log && fabs(value) < tolerance)
        value = 0; /* a multiple of the step, but for rounding */
    const double at = scaled(axis, value);
    if (at < low - tolerance || at > high + tolerance || axis->count == AXIS_MAX_TICKS)
        return;
    axis->ticks[axis->count].value = value;
    write_value(axis->ticks[axis->count++].text, value);
}

static void add_linear_ticks(axis_scale *axis) {
    const double rough = (axis->high - axis->low) / LINEAR_TICKS, power = pow(10, floor(log10(rough)));
    const double step = rough / power < 1.5 ? power : rough / power < 3.5 ? 2 * power : 5 * power;
    for (double k = ceil(axis->low / step - 1e-9); k * step <= axis->high * (1 + 1e-9); k++)
        add_tick(axis, k * step);
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

static axis_scale finish(axis_scale axis, const plot_axis *wanted, bool bars) {
    if (wanted->low < wanted->high) {
        axis.low = wanted->low;
        axis.high = wanted->high;
    } else {
        widen(&axis, bars);
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
                include(&axis, panel->series[i].points[k].x);
    return finish(axis, &panel->x, false);
}

axis_scale axis_of_y(const plot_panel *panel, double top, double bottom) {
    axis_scale axis = {.is_log = panel->y.is_log, .low = INFINITY, .high = -INFINITY, .from = bottom, .to = top};
    if (panel->guide > 0)
        include(&axis, panel->guide);
    for (size_t i = 0; i < panel->count; i++)
        for (size_t k = 0; k < panel->series[i].count; k++)
            include(&axis, panel->series[i].points[k].y);
    return finish(axis, &panel->y, has_bars(panel));
}
