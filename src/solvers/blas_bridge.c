/* Threads of the BLAS, where the library at run time lets them be set. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <string.h>

/* Sets the number of threads of OpenBLAS; other libraries are left alone. */
void keyway_set_blas_threads(int threads)
{
  void (*set)(int);
  void *symbol = dlsym(RTLD_DEFAULT, "openblas_set_num_threads");
  if (!symbol) return;
  memcpy(&set, &symbol, sizeof set);
  set(threads);
}
