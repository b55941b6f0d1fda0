/* Parts of the tool that are loaded when they are first needed: what they link loads slowly, or may be missing. */
#ifndef GSCL_TOOL_MODULE_H
#define GSCL_TOOL_MODULE_H

/* A symbol of the module `file` ("gscl-imageio.so"), which stays loaded; NULL: dlerror() says why. */
const void *module_load(const char *file, const char *symbol);

#endif
