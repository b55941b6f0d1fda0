#include "tradeoff/tradeoff_plots.h"

#include <math.h>
#include <string.h>

const char *const tradeoff_plot_names[TRADEOFF_PLOTS] = {"quality_time", "quality_rate", "accuracy", "gradients"};

static const plot_colour blend_colours[] =
    {[GSCL_BLEND_NORMALIZED] = PLOT_BLUE, [GSCL_BLEND_ALPHA] = PLOT_ORANGE, [GSCL_BLEND_SUM] = PLOT_GREEN};

static const char *ssim_title(const tradeoff_encode *e) {
    return isnan(e->ms_ssim) ? "MS-SSIM: the image is too small" : "MS-SSIM";
}

/* ---- Quality against time ---- */

/* The bottom of the PSNR axis.  It cuts off the start of the fits, which would compress the rest of the plot. */
static double bottom_of(const tradeoff_results *r) {
    double low = INFINITY, high = -INFINITY;
    for (size_t i = 0; i < r->effort_count; i++) {
        low = fmin(low, r->efforts[i].psnr);
        high = fmax(high, r->efforts[i].psnr);
    }
    return floor(low - 0.5 * (high - low));
}

static double top_of(const tradeoff_results *r) {
    double high = -INFINITY;
    for (size_t i = 0; i < r->effort_count; i++) {
        high = fmax(high, r->efforts[i].psnr);
        for (uint32_t k = 0; k < r->efforts[i].report.trace_count; k++)
            high = fmax(high, r->efforts[i].report.trace[k].psnr);
    }
    return ceil(2 * high + 0.2) / 2;
}

static void add_trace(plot_panel *panel, const tradeoff_encode *e, bool named) {
    const bool is_default = e->effort == GSCL_DEFAULT_EFFORT;
    plot_series *curve = plot_add_series(panel, named ? "PSNR during its fit, before the size is met" : "", PLOT_FAINT,
                                         is_default ? PLOT_BLUE : PLOT_GREY);
    for (uint32_t i = 0; i < e->report.trace_count; i++)
        plot_add_point(curve, e->report.trace[i].seconds, e->report.trace[i].psnr, false, " ");
}

static void plot_time(const tradeoff_results *r, plot *p) {
    p->title = "Quality against encode time, all files of one size";
    plot_panel *psnr = plot_add_panel(p, "PSNR", "seconds to encode", "PSNR, dB");
    plot_panel *ssim = plot_add_panel(p, ssim_title(&r->efforts[0]), "seconds to encode", "MS-SSIM");
    psnr->x.is_log = ssim->x.is_log = true;
    if (r->effort_count > 1) {
        psnr->y.low = bottom_of(r);
        psnr->y.high = top_of(r);
    }
    for (size_t i = 0; i < r->effort_count; i++)
        add_trace(psnr, &r->efforts[i], i == 0);
    plot_series *points = plot_add_series(psnr, "file of each effort", PLOT_POINTS, PLOT_BLUE);
    plot_series *others = plot_add_series(ssim, "file of each effort", PLOT_POINTS, PLOT_BLUE);
    for (size_t i = 0; i < r->effort_count; i++) {
        const tradeoff_encode *e = &r->efforts[i];
        const bool is_default = e->effort == GSCL_DEFAULT_EFFORT;
        plot_add_point(points, e->encode_s, e->psnr, is_default, "%d%s", e->effort, is_default ? " (default)" : "");
        plot_add_point(others, e->encode_s, e->ms_ssim, is_default, "%d%s", e->effort, is_default ? " (default)" : "");
    }
}

/* ---- Quality against rate ---- */

static void add_rate(plot_series *series, const tradeoff_encode *e, double quality) {
    plot_add_point(series, e->bpp, quality, false, "%.1f s, %.1f ms", e->encode_s, 1e3 * e->decode_s);
}

static void plot_rate(const tradeoff_results *r, plot *p) {
    p->title = "Quality against rate, with the time to encode and to decode";
    plot_panel *psnr = plot_add_panel(p, "PSNR", "bits per pixel", "PSNR, dB");
    plot_panel *ssim = plot_add_panel(p, ssim_title(&r->efforts[0]), "bits per pixel", "MS-SSIM");
    psnr->x.is_log = ssim->x.is_log = true;
    plot_series *points = plot_add_series(psnr, "", PLOT_POINTS, PLOT_BLUE);
    plot_series *others = plot_add_series(ssim, "", PLOT_POINTS, PLOT_BLUE);
    for (size_t i = 0; i < r->rate_count; i++) {
        add_rate(points, &r->rates[i], r->rates[i].psnr);
        add_rate(others, &r->rates[i], r->rates[i].ms_ssim);
    }
}

/* ---- Arithmetic accuracy against time ---- */

static bool is_choice(const gscl_accuracy *a, const char *choice, int blend) {
    return strcmp(a->choice, choice) == 0 && (int)a->blend == blend;
}

static void plot_support(const tradeoff_results *r, plot *p) {
    plot_panel *panel =
        plot_add_panel(p, "Support of the Gaussian", "ns per pixel to draw", "mean error, units of 1/255");
    panel->y.is_log = true;
    panel->guide = 0.25;
    panel->guide_label = "rounding to 8 bits";
    for (int blend = GSCL_BLEND_NORMALIZED; blend <= GSCL_BLEND_SUM; blend++) {
        plot_series *s = plot_add_series(panel, blend_words[blend], PLOT_POINTS, blend_colours[blend]);
        for (size_t i = 0; i < r->accuracy_count; i++) {
            const gscl_accuracy *a = &r->accuracies[i].row;
            if (is_choice(a, "support", blend))
                plot_add_point(s, a->ns_per_pixel, a->mean_error, a->is_default, "%.3gσ", a->value);
        }
    }
}

/* The name of a bar, or NULL.  The default configuration is measured under each choice, and shown once. */
static const char *arithmetic_name(const tradeoff_accuracy *a) {
    const char *choice = a->row.choice;
    if (strcmp(choice, "precision") == 0)
        return a->row.is_default ? "default" : a->variant;
    const bool shown = !a->row.is_default && (strcmp(choice, "exponential") == 0 || strcmp(choice, "early stop") == 0);
    return shown ? a->variant : NULL;
}

/* Adds the default first, then the variants by choice. */
static void add_categories(plot_panel *panel, const tradeoff_results *r) {
    plot_category(panel, "default");
    for (int pass = 0; pass < 3; pass++) {
        static const char *const choices[] = {"exponential", "precision", "early stop"};
        for (size_t i = 0; i < r->accuracy_count; i++)
            if (strcmp(r->accuracies[i].row.choice, choices[pass]) == 0 && arithmetic_name(&r->accuracies[i]))
                plot_category(panel, arithmetic_name(&r->accuracies[i]));
    }
}

static const char arithmetic_axis[] = "below 1/n: splats behind a transmittance of less than 1/n are skipped";

static void plot_arithmetic(const tradeoff_results *r, plot *p) {
    plot_panel *error = plot_add_panel(p, "Arithmetic: error", arithmetic_axis, "largest error, units of 1/255");
    plot_panel *time = plot_add_panel(p, "Arithmetic: time", arithmetic_axis, "ns per pixel to draw");
    error->y.is_log = true;
    error->guide = 1;
    error->guide_label = "limit of the format";
    add_categories(error, r);
    add_categories(time, r);
    for (int blend = GSCL_BLEND_NORMALIZED; blend <= GSCL_BLEND_SUM; blend++) {
        plot_series *e = plot_add_series(error, blend_words[blend], PLOT_BARS, blend_colours[blend]);
        plot_series *t = plot_add_series(time, blend_words[blend], PLOT_BARS, blend_colours[blend]);
        for (size_t i = 0; i < r->accuracy_count; i++) {
            const gscl_accuracy *a = &r->accuracies[i].row;
            const char *name = arithmetic_name(&r->accuracies[i]);
            if (!name || (int)a->blend != blend)
                continue;
            plot_add_point(e, plot_category(error, name), a->largest_error, a->is_default, " ");
            plot_add_point(t, plot_category(time, name), a->ns_per_pixel, a->is_default, " ");
        }
    }
}

static void plot_quantiser(const tradeoff_results *r, plot *p) {
    plot_panel *panel = plot_add_panel(p, "Quantiser steps", "bits per splat", "PSNR, dB");
    for (int blend = GSCL_BLEND_NORMALIZED; blend <= GSCL_BLEND_SUM; blend++) {
        plot_series *rounded = NULL, *encoded = NULL;
        char name[PLOT_LABEL_SIZE];
        for (size_t i = 0; i < r->accuracy_count; i++) {
            const gscl_accuracy *a = &r->accuracies[i].row;
            if (!is_choice(a, "quantiser", blend) || a->bits_per_splat == 0)
                continue;
            if (!rounded) {
                snprintf(name, sizeof name, "%s, the same splats rounded", blend_words[blend]);
                rounded = plot_add_series(panel, name, PLOT_DASHED, blend_colours[blend]);
                snprintf(name, sizeof name, "%s, encoded to the same size", blend_words[blend]);
                encoded = plot_add_series(panel, name, PLOT_POINTS, blend_colours[blend]);
            }
            plot_add_point(rounded, a->bits_per_splat, a->psnr, a->is_default, " ");
            plot_add_point(encoded, a->bits_per_splat, r->accuracies[i].psnr_same_size, a->is_default, "×%g", a->value);
        }
    }
}

/* ---- Gradient accuracy against time ---- */

static const char *exponential_name(const gscl_gradient_accuracy *g) {
    return g->is_default ? "polynomial (default)" : g->variant;
}

static void plot_gradients(const tradeoff_results *r, plot *p) {
    p->title = "Gradients in single precision, against differences in double precision";
    plot_panel *error = plot_add_panel(p, "Error", "", "relative error, root mean square");
    plot_panel *time = plot_add_panel(p, "Time", "exponential", "ns per pixel of a step");
    error->y.is_log = true;
    for (size_t i = 0; i < r->gradient_count; i++) { /* categories in the order of the rows */
        plot_category(error, r->gradients[i].kind);
        plot_category(time, exponential_name(&r->gradients[i]));
    }
    for (int blend = GSCL_BLEND_NORMALIZED; blend <= GSCL_BLEND_SUM; blend++) {
        plot_series *e = plot_add_series(error, blend_words[blend], PLOT_BARS, blend_colours[blend]);
        plot_series *t = plot_add_series(time, blend_words[blend], PLOT_BARS, blend_colours[blend]);
        for (size_t i = 0; i < r->gradient_count; i++) {
            const gscl_gradient_accuracy *g = &r->gradients[i];
            if ((int)g->blend != blend)
                continue;
            if (g->is_default)
                plot_add_point(e, plot_category(error, g->kind), g->rms_error, false, " ");
            if (strcmp(g->kind, "position") == 0)
                plot_add_point(t, plot_category(time, exponential_name(g)), g->ns_per_pixel, g->is_default, " ");
        }
    }
}

void tradeoff_plot(const tradeoff_plan *plan, const tradeoff_results *r, int number, plot *p) {
    memset(p, 0, sizeof *p);
    p->columns = 2;
    p->subtitle = r->subtitle;
    (void)plan;
    switch (number) {
    case 0:
        plot_time(r, p);
        break;
    case 1:
        plot_rate(r, p);
        break;
    case 2:
        p->title = "Accuracy of the renderer against time";
        plot_support(r, p);
        plot_quantiser(r, p);
        plot_arithmetic(r, p);
        break;
    default:
        plot_gradients(r, p);
    }
}
