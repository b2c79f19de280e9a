/* The few calls of CHOLMOD that solver_cholmod needs, behind plain arguments, so that Fortran does
 * not have to know the structures, which differ from version to version. */
#include "supernodes/cholmod_factor.h"
#include "supernodes/supernodal_solve.h"
#include <omp.h>
#include <stdlib.h>
#include <string.h>

/* The lower triangle of a matrix: 0-based columns of `used` entries each, with room behind them. */
static cholmod_sparse view(int n, const int *start, const int *used, const int *row,
                           const double *values)
{
  cholmod_sparse a;
  memset(&a, 0, sizeof a);
  a.nrow = a.ncol = (size_t)n;
  a.nzmax = (size_t)start[n];
  a.p = (void *)start;
  a.nz = (void *)used;
  a.i = (void *)row;
  a.x = (void *)values;
  a.stype = -1;
  a.itype = CHOLMOD_INT;
  a.xtype = values ? CHOLMOD_REAL : CHOLMOD_PATTERN;
  a.dtype = CHOLMOD_DOUBLE;
  a.sorted = 1;
  a.packed = 0;
  return a;
}

/* NULL when there is no memory. */
void *keyway_cholmod_start(void)
{
  struct keyway_cholmod *c = calloc(1, sizeof *c);
  if (!c) return NULL;
  cholmod_start(&c->common);
  c->common.print = 0;
  c->common.supernodal = CHOLMOD_SUPERNODAL;
  c->common.final_ll = 1;
  c->common.nmethods = 1;
  c->common.postorder = 1;
  c->common.quick_return_if_not_posdef = 1;
  return c;
}

void keyway_cholmod_finish(void *handle)
{
  struct keyway_cholmod *c = handle;
  if (!c) return;
  keyway_free_top(c);
  cholmod_free_dense(&c->x, &c->common);
  cholmod_free_dense(&c->y, &c->common);
  cholmod_free_dense(&c->e, &c->common);
  keyway_free_single(c);
  keyway_free_subtrees(&c->trees);
  cholmod_free_factor(&c->factor, &c->common);
  cholmod_finish(&c->common);
  free(c->is_upper);
  free(c->work);
  free(c);
}

/* Rearranges `order` by a postorder of the elimination tree, which makes supernodes, and leaves its
 * last m unknowns where they are: any order with children before parents has the same fill. Returns
 * 0 for success. */
static int postorder(struct keyway_cholmod *c, cholmod_sparse *a, int m, int *order)
{
  int n = (int)a->nrow, k, used = 0;
  int *work = malloc(6 * (size_t)n * sizeof *work);
  int *post, *old;
  if (!work) return -1;
  post = work + n;
  old = work + 5 * (size_t)n;
  if (!cholmod_analyze_ordering(a, CHOLMOD_GIVEN, order, NULL, 0, work, post, work + 2 * (size_t)n,
                                work + 3 * (size_t)n, work + 4 * (size_t)n, &c->common)) {
    free(work);
    return c->common.status ? c->common.status : -1;
  }
  memcpy(old, order, (size_t)n * sizeof *old);
  for (k = 0; k < n; k++)
    if (post[k] < n - m) order[used++] = old[post[k]];
  free(work);
  return 0;
}

/* Threads beyond these do not read a factor any faster. */
enum { most_threads = 16 };

/* Chooses the parts of the factor in which threads substitute. */
static void plan_threads(struct keyway_cholmod *c)
{
  struct keyway_supernodes nodes;
  int num_threads = omp_in_parallel() ? 1 : omp_get_max_threads();
  if (num_threads > most_threads) num_threads = most_threads;
  if (!c->factor->is_super) return;
  nodes = keyway_supernodes_of(c);
  keyway_plan_subtrees(&nodes, num_threads, &c->trees);
}

/* Plans the factor. `order` lists the unknowns in the order of elimination, 0-based, of which the
 * last m stay the last; NULL leaves it to CHOLMOD's own METIS. Returns CHOLMOD's status, 0 for
 * success. */
int keyway_cholmod_analyse(void *handle, int n, const int *start, const int *used, const int *row,
                           int m, int *order)
{
  struct keyway_cholmod *c = handle;
  cholmod_sparse a = view(n, start, used, row, NULL);
  keyway_free_top(c);
  keyway_free_single(c);
  keyway_free_subtrees(&c->trees);
  cholmod_free_factor(&c->factor, &c->common);
  free(c->is_upper);
  free(c->work);
  c->is_upper = NULL;
  c->work = NULL;
  c->common.method[0].ordering = order ? CHOLMOD_GIVEN : CHOLMOD_METIS;
  if (order && m > 0) {
    int status = postorder(c, &a, m, order);
    if (status) return status;
    c->common.postorder = 0;
  }
  c->factor = cholmod_analyze_p(&a, order, NULL, 0, &c->common);
  c->common.postorder = 1;
  if (!c->factor) return c->common.status ? c->common.status : -1;
  plan_threads(c);
  return 0;
}

/* The smallest square of a pivot over the entry it came from, and its column. */
static double smallest_pivot(const cholmod_factor *l, const int *start, const double *values,
                             int *column)
{
  const int *super = l->super, *pi = l->pi, *px = l->px, *perm = l->Perm;
  const double *x = l->x;
  double smallest = 1.0;
  *column = 0;
  for (size_t s = 0; s < l->nsuper; s++) {
    size_t stride = (size_t)(pi[s + 1] - pi[s]) + 1;
    for (int k = super[s]; k < super[s + 1]; k++) {
      double pivot = x[(size_t)px[s] + (size_t)(k - super[s]) * stride];
      double ratio = pivot * pivot / values[start[perm[k]]];
      if (!(ratio >= smallest)) {
        smallest = ratio;
        *column = perm[k];
      }
    }
  }
  return smallest;
}

/* Factors. Returns CHOLMOD's status: 0 success, 1 not positive definite, negative errors. `column`
 * is the 0-based unknown whose pivot failed or is smallest, `ratio` that pivot over the diagonal
 * entry. */
int keyway_cholmod_factorise(void *handle, int n, const int *start, const int *used,
                             const int *row, const double *values, int *column, double *ratio)
{
  struct keyway_cholmod *c = handle;
  cholmod_sparse a = view(n, start, used, row, values);
  *column = 0;
  *ratio = 0.0;
  keyway_free_single(c);
  if (!cholmod_factorize(&a, c->factor, &c->common)) return c->common.status;
  if (c->common.status == CHOLMOD_NOT_POSDEF) {
    if (c->factor->minor < c->factor->n) *column = ((int *)c->factor->Perm)[c->factor->minor];
    return 1;
  }
  if (c->common.status == CHOLMOD_OK && c->factor->is_super)
    *ratio = smallest_pivot(c->factor, start, values, column);
  return c->common.status;
}

/* y = L^-1 y, or y = L^-T y, on a part of the supernodes, in the order of elimination; with
 * `in_single` by the copy in single precision. Returns 0 for success. */
int keyway_cholmod_substitute(void *handle, int in_single, int part, int is_forward, int n,
                              double *y)
{
  struct keyway_cholmod *c = handle;
  struct keyway_supernodes nodes =
    in_single ? keyway_supernodes_of_copy(c) : keyway_supernodes_of(c);
  if (in_single && !c->copy) return 1;
  if (!c->work) c->work = malloc(((size_t)n + 1) * sizeof *c->work);
  if (!c->work || (part != KEYWAY_WHOLE && !c->is_upper) || n != (int)c->factor->n) return 1;
  if (c->trees.num_trees > 0 && is_forward)
    keyway_forward_in_trees(&nodes, part, c->is_upper, &c->trees, y);
  else if (c->trees.num_trees > 0)
    keyway_backward_in_trees(&nodes, part, c->is_upper, &c->trees, y);
  else if (is_forward)
    keyway_substitute_forward(&nodes, part, c->is_upper, y, c->work);
  else
    keyway_substitute_backward(&nodes, part, c->is_upper, y, c->work);
  return 0;
}

/* Solves with our own substitution, column by column. */
static int solve_columns(struct keyway_cholmod *c, int n, int columns, double *b)
{
  const int *perm = c->factor->Perm;
  double *y = malloc((size_t)n * sizeof *y);
  int status = y == NULL;
  for (int j = 0; j < columns && status == 0; j++, b += n) {
    for (int k = 0; k < n; k++) y[k] = b[perm[k]];
    status = keyway_cholmod_substitute(c, 0, KEYWAY_WHOLE, 1, n, y) ||
             keyway_cholmod_substitute(c, 0, KEYWAY_WHOLE, 0, n, y);
    for (int k = 0; k < n; k++) b[perm[k]] = y[k];
  }
  free(y);
  return status;
}

/* Solves for `columns` right-hand sides of length n, in place. Returns 0 for success. CHOLMOD reads
 * the factor once for all of them, but takes longer than our own substitution for a single one. */
int keyway_cholmod_solve(void *handle, int n, int columns, double *b)
{
  struct keyway_cholmod *c = handle;
  cholmod_dense rhs;
  if (c->single || (columns == 1 && c->factor->is_super && c->factor->x))
    return solve_columns(c, n, columns, b);
  memset(&rhs, 0, sizeof rhs);
  rhs.nrow = rhs.d = (size_t)n;
  rhs.ncol = (size_t)columns;
  rhs.nzmax = (size_t)n * (size_t)columns;
  rhs.x = b;
  rhs.xtype = CHOLMOD_REAL;
  rhs.dtype = CHOLMOD_DOUBLE;
  if (!cholmod_solve2(CHOLMOD_A, c->factor, &rhs, NULL, &c->x, NULL, &c->y, &c->e, &c->common))
    return c->common.status ? c->common.status : -1;
  memcpy(b, c->x->x, rhs.nzmax * sizeof(double));
  return 0;
}

/* The end of the factor: the lower triangle, dense, of its last m columns, and the unknowns they
 * belong to, 0-based. Returns 0 when these are the last m unknowns, in whatever order. */
int keyway_cholmod_end(void *handle, int n, int m, double *block, int *unknown)
{
  const cholmod_factor *l = ((struct keyway_cholmod *)handle)->factor;
  const int *super = l->super, *pi = l->pi, *px = l->px, *rows = l->s, *perm = l->Perm;
  const double *x = l->x;
  int first = n - m;
  if (!l->is_super || !x) return 1;
  for (int k = first; k < n; k++) {
    unknown[k - first] = perm[k];
    if (perm[k] < first) return 1;
  }
  memset(block, 0, (size_t)m * (size_t)m * sizeof *block);
  for (size_t s = 0; s < l->nsuper; s++) {
    int count = pi[s + 1] - pi[s];
    for (int k = super[s] > first ? super[s] : first; k < super[s + 1]; k++) {
      const double *column = x + px[s] + (size_t)(k - super[s]) * (size_t)count;
      for (int i = k - super[s]; i < count; i++)
        block[(size_t)(k - first) * (size_t)m + (size_t)(rows[pi[s] + i] - first)] = column[i];
    }
  }
  return 0;
}

/* Chooses the active unknowns, 0-based. Returns the share of their part in the factor; negative
 * without memory, or where the factor has no supernodes. */
double keyway_cholmod_choose(void *handle, int n, int count, const int *unknown)
{
  struct keyway_cholmod *c = handle;
  const cholmod_factor *l = c->factor;
  struct keyway_supernodes nodes;
  double share = -1.0;
  int *place = malloc((size_t)n * sizeof *place), *column = malloc((size_t)count * sizeof *column);
  free(c->is_upper);
  c->is_upper = malloc(l->nsuper + 1);
  if (place && column && c->is_upper && l->is_super) {
    const int *perm = l->Perm;
    for (int k = 0; k < n; k++) place[perm[k]] = k;
    for (int k = 0; k < count; k++) column[k] = place[unknown[k]];
    nodes = keyway_supernodes_of(c);
    share = keyway_mark_upper(&nodes, count, column, c->is_upper);
  }
  free(place);
  free(column);
  return share;
}

/* Entries of the factor as planned, bytes held now and at the peak. */
void keyway_cholmod_statistics(void *handle, double *entries, double *bytes, double *peak)
{
  struct keyway_cholmod *c = handle;
  *entries = c->common.lnz;
  *bytes = (double)c->common.memory_inuse;
  *peak = (double)c->common.memory_usage;
}

/* The order of elimination in use, 0-based. */
void keyway_cholmod_order(void *handle, int n, int *order)
{
  struct keyway_cholmod *c = handle;
  memcpy(order, c->factor->Perm, (size_t)n * sizeof(int));
}
