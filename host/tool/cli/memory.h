/* How the C library returns memory to the system. */
#ifndef GSCL_TOOL_MEMORY_H
#define GSCL_TOOL_MEMORY_H

/* Lets large blocks go back as soon as they are freed, where the C library keeps them otherwise.  Before other threads. */
void memory_return_freed(void);

#endif
