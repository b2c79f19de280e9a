/* CHOLMOD as a program would use it that has nothing else: a supernodal factor, and solves of one
 * right-hand side whose workspace is kept. */
#include <cholmod.h>
#include <string.h>
#include <time.h>

static double now(void)
{
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Factors the lower triangle of a matrix (0-based columns of `used` entries, with room behind them)
 * in a given order of elimination, or in that of METIS where `order` is NULL, and solves `count`
 * times. Returns 0 for success. */
int bare_solve(int n, const int *start, const int *used, const int *row, const double *values,
               int *order, int count, double *entries, double *factor, double *seconds)
{
  cholmod_common common;
  cholmod_sparse a;
  cholmod_dense *b, *x = NULL, *y = NULL, *e = NULL;
  cholmod_factor *l;
  double start_time;
  int is_well;
  memset(&a, 0, sizeof a);
  a.nrow = a.ncol = (size_t)n;
  a.nzmax = (size_t)start[n];
  a.p = (void *)start;
  a.nz = (void *)used;
  a.i = (void *)row;
  a.x = (void *)values;
  a.stype = -1;
  a.itype = CHOLMOD_INT;
  a.xtype = CHOLMOD_REAL;
  a.dtype = CHOLMOD_DOUBLE;
  a.sorted = 1;
  cholmod_start(&common);
  common.supernodal = CHOLMOD_SUPERNODAL;
  common.final_ll = 1;
  common.nmethods = 1;
  common.method[0].ordering = order ? CHOLMOD_GIVEN : CHOLMOD_METIS;
  common.postorder = order == NULL;
  l = cholmod_analyze_p(&a, order, NULL, 0, &common);
  start_time = now();
  is_well = l && cholmod_factorize(&a, l, &common) && common.status == CHOLMOD_OK;
  *factor = now() - start_time;
  *entries = common.lnz;
  b = cholmod_ones((size_t)n, 1, CHOLMOD_REAL, &common);
  for (int k = -1; k < count && is_well && b; k++) { /* the first takes the workspace */
    start_time = now();
    is_well = cholmod_solve2(CHOLMOD_A, l, b, NULL, &x, NULL, &y, &e, &common);
    if (k >= 0) seconds[k] = now() - start_time;
  }
  is_well = is_well && b;
  cholmod_free_dense(&b, &common);
  cholmod_free_dense(&x, &common);
  cholmod_free_dense(&y, &common);
  cholmod_free_dense(&e, &common);
  cholmod_free_factor(&l, &common);
  cholmod_finish(&common);
  return is_well ? 0 : 1;
}
