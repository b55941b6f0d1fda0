/* Parts of the tool that are loaded on first use, because the libraries that they link load slowly or may be missing. */
#ifndef GSCL_TOOL_MODULE_H
#define GSCL_TOOL_MODULE_H

/* A symbol of the module `file` ("gscl-imageio.so"), which stays loaded.  NULL on failure. */
const void *module_load(const char *file, const char *symbol);

/* Why module_load has failed. */
const char *module_error(void);

#endif
