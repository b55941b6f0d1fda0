/* Uses the gdk-pixbuf loader as programs do.
 *     use_loader load PART WIDTH HEIGHT OUT FILE...  feeds each file in parts of PART bytes, asks for WIDTH x HEIGHT pixels if
 *         those are not 0, writes the pixels to OUT/N.raw and prints a line: "WIDTH HEIGHT CHANNELS PREPARED UPDATED PROFILE"
 *         (numbers of signals, length of the profile in base64), then "ok" or the error
 *     use_loader save OUT [KEY=VALUE]  writes a picture of 64 x 48 pixels
 *     use_loader convert IN OUT  reads a file of any format and writes it as gscl */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <gdk-pixbuf/gdk-pixbuf.h>

typedef struct watcher {
    int width, height; /* to ask for */
    int prepared, updated;
} watcher;

static void size_prepared(GdkPixbufLoader *loader, int width, int height, gpointer data) {
    const watcher *w = data;
    if (w->width && width > 0 && height > 0)
        gdk_pixbuf_loader_set_size(loader, w->width, w->height);
}

static void area_prepared(GdkPixbufLoader *loader, gpointer data) {
    (void)loader;
    ((watcher *)data)->prepared++;
}

static void area_updated(GdkPixbufLoader *loader, int x, int y, int width, int height, gpointer data) {
    (void)loader, (void)x, (void)y, (void)width, (void)height;
    ((watcher *)data)->updated++;
}

static void write_pixels(const GdkPixbuf *pixbuf, const char *name) {
    FILE *file = fopen(name, "wb");
    if (!file)
        exit(2);
    const size_t row = (size_t)gdk_pixbuf_get_width(pixbuf) * (size_t)gdk_pixbuf_get_n_channels(pixbuf);
    for (int y = 0; y < gdk_pixbuf_get_height(pixbuf); y++)
        fwrite(gdk_pixbuf_read_pixels(pixbuf) + (size_t)y * (size_t)gdk_pixbuf_get_rowstride(pixbuf), 1, row, file);
    fclose(file);
}

static void load(const char *name, gsize part, watcher w, const char *out) {
    gchar *bytes;
    gsize size;
    GError *error = NULL;
    if (!g_file_get_contents(name, &bytes, &size, NULL))
        exit(2);
    GdkPixbufLoader *loader = gdk_pixbuf_loader_new_with_type("gscl", NULL);
    g_signal_connect(loader, "size-prepared", G_CALLBACK(size_prepared), &w);
    g_signal_connect(loader, "area-prepared", G_CALLBACK(area_prepared), &w);
    g_signal_connect(loader, "area-updated", G_CALLBACK(area_updated), &w);
    gboolean ok = TRUE;
    for (gsize at = 0; ok && at < size; at += part)
        ok = gdk_pixbuf_loader_write(loader, (const guchar *)bytes + at, MIN(part, size - at), &error);
    ok = gdk_pixbuf_loader_close(loader, error ? NULL : &error) && ok;
    const GdkPixbuf *pixbuf = gdk_pixbuf_loader_get_pixbuf(loader);
    if (pixbuf) {
        const char *profile = gdk_pixbuf_get_option((GdkPixbuf *)pixbuf, "icc-profile");
        write_pixels(pixbuf, out);
        printf("%d %d %d %d %d %zu ", gdk_pixbuf_get_width(pixbuf), gdk_pixbuf_get_height(pixbuf),
               gdk_pixbuf_get_n_channels(pixbuf), w.prepared, w.updated, profile ? strlen(profile) : 0);
    } else
        printf("0 0 0 0 0 0 ");
    puts(ok ? "ok" : error ? error->message : "failed without an error");
    g_clear_error(&error);
    g_object_unref(loader);
    g_free(bytes);
}

static int save(const char *name, const char *option) {
    GdkPixbuf *pixbuf = gdk_pixbuf_new(GDK_COLORSPACE_RGB, FALSE, 8, 64, 48);
    GError *error = NULL;
    char *key = g_strdup(option ? option : "");
    char *value = strchr(key, '=');
    gdk_pixbuf_fill(pixbuf, 0x3060c0ff);
    if (value)
        *value++ = '\0';
    const gboolean ok = value ? gdk_pixbuf_save(pixbuf, name, "gscl", &error, key, value, "effort", "0", NULL)
                              : gdk_pixbuf_save(pixbuf, name, "gscl", &error, NULL);
    puts(ok ? "ok" : error->message);
    g_clear_error(&error);
    g_free(key);
    g_object_unref(pixbuf);
    return 0;
}

static int convert(const char *from, const char *to) {
    GError *error = NULL;
    GdkPixbuf *pixbuf = gdk_pixbuf_new_from_file(from, &error);
    const gboolean ok = pixbuf && gdk_pixbuf_save(pixbuf, to, "gscl", &error, "effort", "0", NULL);
    puts(ok ? "ok" : error->message);
    g_clear_error(&error);
    g_clear_object(&pixbuf);
    return 0;
}

int main(int argc, char **argv) {
    if (argc == 4 && strcmp(argv[1], "convert") == 0)
        return convert(argv[2], argv[3]);
    if (argc >= 3 && strcmp(argv[1], "save") == 0)
        return save(argv[2], argv[3]);
    if (argc < 6)
        return 2;
    const watcher w = {.width = atoi(argv[3]), .height = atoi(argv[4])};
    for (int i = 6; i < argc; i++) {
        char *out = g_strdup_printf("%s/%d.raw", argv[5], i - 6);
        load(argv[i], (gsize)atoi(argv[2]), w, out);
        g_free(out);
    }
    return 0;
}
