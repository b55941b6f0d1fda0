#include "codebook/codebook_step.h"

#include "cl/structs.h"
#include "codebook/tunables.h"
#include "runtime/vectors.h"

static gscl_result round_book(gscl_codebook *c, int which) {
    gscl_book *book = &c->books[which];
    const int32_t number = which, count = book->count, levels = (1 << book->bits) - 1;
    gscl_kernel *kernel;
    GSCL_TRY(
        gscl_kernel_find(c->fit->context, GSCL_PROGRAM_CODEBOOK, &c->fit->renderer.options, "book_quantise", &kernel));
    return GSCL_LAUNCH(c->fit->context, kernel, (size_t)gscl_codebook_dims(c, which), GSCL_BOOK_GROUP,
                       GSCL_ARG_BUFFER(book->learnt), GSCL_ARG(number), GSCL_ARG(count), GSCL_ARG(levels),
                       GSCL_ARG_BUFFER(book->stored));
}

gscl_result gscl_codebook_project(gscl_codebook *c) {
    gscl_renderer *r = &c->fit->renderer;
    gscl_kernel *kernel;
    gscl_float2 cell = {{(float)c->fit->pyramid.width / (float)(1 << c->position_bits),
                         (float)c->fit->pyramid.height / (float)(1 << c->position_bits)}};
    gscl_int2 last = {{(1 << c->position_bits) - 1, (1 << c->position_bits) - 1}};
    for (int b = 0; b < GSCL_BOOKS; b++)
        GSCL_TRY(round_book(c, b));
    GSCL_TRY(gscl_kernel_find(r->context, GSCL_PROGRAM_CODEBOOK, &r->options, "book_apply", &kernel));
    GSCL_TRY(GSCL_LAUNCH(r->context, kernel, gscl_groups(gscl_codebook_splats(c), GSCL_SPLATS_PER_GROUP),
                         GSCL_SPLATS_PER_GROUP, GSCL_ARG_BUFFER(c->learnt), GSCL_ARG_BUFFER(c->indices),
                         GSCL_ARG_BUFFER(c->books[GSCL_BOOK_SHAPE].stored),
                         GSCL_ARG_BUFFER(c->books[GSCL_BOOK_COLOUR].stored), GSCL_ARG(r->count), GSCL_ARG(cell),
                         GSCL_ARG(last), GSCL_ARG_BUFFER(r->params)));
    return gscl_renderer_project(r);
}

gscl_result gscl_codebook_step_straight_through(gscl_codebook *c, float rate) {
    GSCL_TRY(gscl_codebook_project(c));
    GSCL_TRY(gscl_fit_differentiate(c->fit));
    return gscl_fit_adam(c->fit, &c->learnt, rate);
}

static gscl_word_step_settings step_settings(const gscl_codebook *c, int which) {
    return (gscl_word_step_settings){.book = which,
                                     .words = c->books[which].count,
                                     .splats = c->fit->renderer.count,
                                     .age = c->age,
                                     .shape_rate = gscl_codebook_tunables.shape_rate,
                                     .position_rate = gscl_codebook_tunables.position_rate};
}

static gscl_result step_book(gscl_codebook *c, int which) {
    gscl_book *book = &c->books[which];
    gscl_fit *f = c->fit;
    const gscl_word_step_settings settings = step_settings(c, which);
    gscl_kernel *kernel;
    GSCL_TRY(gscl_kernel_find(f->context, GSCL_PROGRAM_CODEBOOK, &f->renderer.options, "book_step", &kernel));
    return GSCL_LAUNCH(f->context, kernel, (size_t)book->count, GSCL_BOOK_GROUP, GSCL_ARG_BUFFER(book->learnt),
                       GSCL_ARG_BUFFER(book->first_moment), GSCL_ARG_BUFFER(book->second_moment),
                       GSCL_ARG_BUFFER(c->indices), GSCL_ARG_BUFFER(f->gradients), GSCL_ARG(settings),
                       GSCL_ARG(f->limits));
}

static gscl_result step_positions(gscl_codebook *c) {
    gscl_fit *f = c->fit;
    const gscl_word_step_settings settings = step_settings(c, GSCL_BOOK_SHAPE);
    gscl_kernel *kernel;
    GSCL_TRY(gscl_kernel_find(f->context, GSCL_PROGRAM_CODEBOOK, &f->renderer.options, "position_step", &kernel));
    return GSCL_LAUNCH(f->context, kernel, gscl_groups(gscl_codebook_splats(c), GSCL_SPLATS_PER_GROUP),
                       GSCL_SPLATS_PER_GROUP, GSCL_ARG_BUFFER(c->learnt), GSCL_ARG_BUFFER(f->first_moment),
                       GSCL_ARG_BUFFER(f->second_moment), GSCL_ARG_BUFFER(f->ages), GSCL_ARG_BUFFER(f->renderer.params),
                       GSCL_ARG_BUFFER(f->gradients), GSCL_ARG(settings), GSCL_ARG(f->limits));
}

gscl_result gscl_codebook_step(gscl_codebook *c, float rate) {
    GSCL_TRY(gscl_codebook_project(c));
    GSCL_TRY(gscl_fit_differentiate(c->fit));
    c->fit->limits.rate = rate;
    c->age++;
    for (int b = 0; b < GSCL_BOOKS; b++)
        GSCL_TRY(step_book(c, b));
    return step_positions(c);
}

gscl_result gscl_codebook_restart_optimiser(gscl_codebook *c) {
    gscl_fit *f = c->fit;
    const size_t splats = gscl_codebook_splats(c), row = GSCL_PARAMS * sizeof(float);
    c->age = 0;
    for (int b = 0; b < GSCL_BOOKS; b++) {
        GSCL_TRY(gscl_buffer_zero(f->context, &c->books[b].first_moment, 0, GSCL_BOOK_BYTES));
        GSCL_TRY(gscl_buffer_zero(f->context, &c->books[b].second_moment, 0, GSCL_BOOK_BYTES));
    }
    GSCL_TRY(gscl_buffer_zero(f->context, &f->first_moment, 0, splats * row));
    GSCL_TRY(gscl_buffer_zero(f->context, &f->second_moment, 0, splats * row));
    return gscl_buffer_zero(f->context, &f->ages, 0, splats * sizeof(int32_t));
}
