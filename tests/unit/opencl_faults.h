/* Calls of OpenCL that fail (faults.h). */
#ifndef GSCL_TESTS_OPENCL_FAULTS_H
#define GSCL_TESTS_OPENCL_FAULTS_H

/* Takes the place of functions of OpenCL that the library calls; to be called first. */
void opencl_faults_install(void);

#endif
