#include "tradeoff/tradeoff_files.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "cli/message.h"
#include "cli/module.h"
#include "host/system/files.h"
#include "tradeoff/tradeoff_tables.h"

static const struct {
    const char *name;
    void (*write)(const tradeoff_plan *plan, const tradeoff_results *results, FILE *stream);
} tables[TRADEOFF_TABLES] = {
    {"tradeoff.json", tradeoff_write_json},      {"quality_time.csv", tradeoff_write_efforts},
    {"trace.csv", tradeoff_write_trace},         {"quality_rate.csv", tradeoff_write_rates},
    {"accuracy.csv", tradeoff_write_accuracies}, {"gradients.csv", tradeoff_write_gradients},
};
static const char *const suffixes[] = {[PLOT_SVG] = ".svg", [PLOT_PNG] = ".png"};

static const plot_module *load_module(void) {
    const plot_module *module = module_load(PLOT_MODULE_FILE, PLOT_MODULE_SYMBOL);
    if (!module)
        report_note(
            "gscl: tradeoff: tables only; plots need the module gscl-plot.so, which is built if cairo is installed "
            "(Debian: libcairo2-dev): %s",
            module_error());
    return module;
}

static bool make_folder(tradeoff_files *files) {
    if (system_make_folder(files->folder))
        files->made_folder = true;
    else if (errno != EEXIST)
        return report_error(files->folder, "cannot be made: %s; name a folder inside an existing one",
                            system_error_text(errno));
    return true;
}

static bool open_file(tradeoff_files *files, const char *name, const char *suffix) {
    const size_t size = strlen(files->folder) + strlen(name) + strlen(suffix) + 2;
    char *path = malloc(size);
    if (!path)
        return report_error(files->folder, "%s", gscl_result_text(GSCL_ERROR_OUT_OF_MEMORY));
    snprintf(path, size, "%s/%s%s", files->folder, name, suffix);
    files->names[files->count] = path;
    if (output_open(&files->outputs[files->count], path)) {
        files->count++;
        return true;
    }
    free(path);
    return false;
}

bool tradeoff_files_open(tradeoff_files *files, const char *folder) {
    *files = (tradeoff_files){.folder = folder, .module = load_module()};
    bool ok = make_folder(files);
    for (size_t i = 0; i < TRADEOFF_TABLES && ok; i++)
        ok = open_file(files, tables[i].name, "");
    for (size_t i = 0; i < TRADEOFF_PLOTS && ok && files->module; i++)
        for (int format = PLOT_SVG; format <= PLOT_PNG && ok; format++)
            ok = open_file(files, tradeoff_plot_names[i], suffixes[format]);
    if (!ok)
        tradeoff_files_discard(files);
    return ok;
}

static bool draw_plots(tradeoff_files *files, const tradeoff_plan *plan, const tradeoff_results *results) {
    plot *p = malloc(sizeof *p);
    bool ok = p != NULL;
    size_t file = TRADEOFF_TABLES;
    for (int i = 0; i < TRADEOFF_PLOTS && ok; i++) {
        tradeoff_plot(plan, results, i, p);
        for (int format = PLOT_SVG; format <= PLOT_PNG && ok; format++, file++)
            /* A failed stream is reported when its file is finished. */
            ok = files->module->draw(p, (plot_format)format, files->outputs[file].stream) ||
                 ferror(files->outputs[file].stream);
    }
    free(p);
    return ok || report_error(files->folder, "the plots cannot be drawn: out of memory");
}

/* Reports the first file that could not be written, before any file is put in place. */
static bool are_written(tradeoff_files *files) {
    for (size_t i = 0; i < files->count; i++) {
        output_file *output = &files->outputs[i];
        errno = 0;
        if (fflush(output->stream) == 0 && !ferror(output->stream))
            continue;
        output->error = errno ? errno : EIO;
        return output_commit(output); /* reports the error */
    }
    return true;
}

bool tradeoff_files_write(tradeoff_files *files, const tradeoff_plan *plan, const tradeoff_results *results) {
    for (size_t i = 0; i < TRADEOFF_TABLES; i++)
        tables[i].write(plan, results, files->outputs[i].stream);
    bool ok = (!files->module || draw_plots(files, plan, results)) && are_written(files);
    for (size_t i = 0; i < files->count && ok; i++)
        ok = output_commit(&files->outputs[i]);
    if (ok)
        files->made_folder = false; /* so that it stays */
    tradeoff_files_discard(files);
    return ok;
}

void tradeoff_files_discard(tradeoff_files *files) {
    for (size_t i = 0; i < files->count; i++) {
        output_discard(&files->outputs[i]);
        free(files->names[i]);
    }
    files->count = 0;
    if (files->made_folder)
        system_remove_folder(files->folder);
    files->made_folder = false;
}
