/* Threads and kernels of the BLAS, where the library at run time lets them be chosen: OpenBLAS.
 * Other libraries are left alone. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* A function of the BLAS by its name; ISO C knows no other way to turn a symbol into one. */
static int find(const char *name, void *function)
{
  void *symbol = dlsym(RTLD_DEFAULT, name);
  memcpy(function, &symbol, sizeof symbol);
  return symbol != NULL;
}

void keyway_set_blas_threads(int threads)
{
  void (*set)(int);
  if (find("openblas_set_num_threads", &set)) set(threads);
}

/* Name of the kernels that OpenBLAS has chosen, in `room` characters; "" for another library. */
void keyway_blas_kernels(char *name, int room)
{
  char *(*get_name)(void);
  name[0] = '\0';
  if (find("openblas_get_corename", &get_name)) snprintf(name, (size_t)room, "%s", get_name());
}

/* 1 when the BLAS threads are OpenMP's. */
int keyway_blas_uses_openmp(void)
{
  int (*get)(void);
  return find("openblas_get_parallel", &get) && get() == 2;
}

void dgemm_(const char *a_form, const char *b_form, const int *m, const int *n, const int *k,
            const double *alpha, const double *a, const int *lda, const double *b, const int *ldb,
            const double *beta, double *c, const int *ldc, size_t, size_t);
void dpotrf_(const char *uplo, const int *n, double *a, const int *lda, int *info, size_t);

void dsymv_(const char *uplo, const int *n, const double *alpha, const double *a, const int *lda,
            const double *x, const int *incx, const double *beta, double *y, const int *incy, size_t);

/* Calls of the kinds that take memory of their own: products and factors of matrices, products with
 * vectors. */
static void call_blas(void)
{
  enum { n = 192 };
  static double a[n * n], c[n * n], x[n], y[n];
  const int size = n, step = 1;
  const double one = 1.0, zero = 0.0;
  int info;
  for (int i = 0; i < n; i++) a[i * (n + 1)] = 1.0;
  dgemm_("N", "N", &size, &size, &size, &one, a, &size, a, &size, &zero, c, &size, 1, 1);
  dpotrf_("L", &size, c, &size, &info, 1);
  dsymv_("L", &size, &one, a, &size, x, &step, &zero, y, &step, 1);
}

/* Lets the BLAS take its memory for so many threads: OpenBLAS keeps it, and would wait for it for
 * ever once the analysis has taken the rest. */
void keyway_warm_up_blas(int threads)
{
  keyway_set_blas_threads(threads);
  call_blas();
  keyway_set_blas_threads(1);
  call_blas();
}

/* The fastest kernels of OpenBLAS that this processor can run, NULL when there is no choice. */
static const char *fitting_kernels(void)
{
#if defined(__x86_64__)
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl") &&
      __builtin_cpu_supports("avx512cd"))
    return "SkylakeX";
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return "Haswell";
#endif
  return NULL;
}

/* The words of the command line, ended by NULL; they stay allocated. */
static char **command_line(void)
{
  static char text[65536];
  char **words;
  size_t length, count = 0;
  FILE *file = fopen("/proc/self/cmdline", "r");
  if (!file) return NULL;
  length = fread(text, 1, sizeof text - 1, file);
  fclose(file);
  if (length == 0 || length == sizeof text - 1) return NULL;
  for (size_t i = 0; i < length; i++) count += text[i] == '\0';
  words = calloc(count + 1, sizeof *words);
  if (!words) return NULL;
  for (size_t i = 0, k = 0; k < count; i += strlen(text + i) + 1) words[k++] = text + i;
  return words;
}

/* 1 when OpenBLAS does not know the processor and the user has not chosen. */
static int has_old_kernels(void)
{
  char *(*get_name)(void);
  if (!fitting_kernels() || getenv("OPENBLAS_CORETYPE")) return 0;
  return find("openblas_get_corename", &get_name) && strcmp(get_name(), "Prescott") == 0;
}

/* Two libraries make choices when they are loaded, so the program starts itself again with the
 * choices made. An OpenBLAS older than the processor falls back to kernels of 2004, five times
 * slower. Threads of OpenMP that wait for work keep their cores busy for milliseconds: the serial
 * solves between short loops then find none free. OpenBLAS starts a thread for each core, which
 * waits busily for a tenth of a second, unless it has a number of `threads` (0: as many as cores). */
void keyway_restart_with_fast_libraries(int threads)
{
  char path[4096], number[16];
  int is_old = has_old_kernels();
  int is_spinning = !getenv("OMP_WAIT_POLICY") && !getenv("GOMP_SPINCOUNT");
  int is_wasteful = threads > 0 && !getenv("OPENBLAS_NUM_THREADS");
  char **words;
  ssize_t length;
  if (!is_old && !is_spinning && !is_wasteful) return;
  length = readlink("/proc/self/exe", path, sizeof path - 1);
  words = command_line();
  if (length <= 0 || !words) return;
  path[length] = '\0';
  if (is_old) setenv("OPENBLAS_CORETYPE", fitting_kernels(), 1);
  if (is_spinning) setenv("OMP_WAIT_POLICY", "PASSIVE", 1);
  snprintf(number, sizeof number, "%d", threads);
  if (is_wasteful) setenv("OPENBLAS_NUM_THREADS", number, 1);
  execv(path, words);
  free(words); /* only reached when the start failed: go on slowly */
}
