/* The few calls of CHOLMOD that solver_cholmod needs, behind plain arguments, so that Fortran does
 * not have to know the structures, which differ from version to version. */
#include "supernodes/selected_inverse.h"
#include "supernodes/supernodal_solve.h"
#include <cholmod.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

struct keyway_cholmod {
  cholmod_common common;
  cholmod_factor *factor;
  cholmod_dense *x, *y, *e; /* workspace of the solves */
  char *is_upper;           /* (supernodes) the part of the active unknowns; NULL: not chosen */
  double *work;             /* as long as the longest column of a supernode */
  /* The top of the factor: supernodes with chosen unknowns, and all their ancestors. */
  char *is_top;
  int *super_of, *place_of;
  long *top_start; /* of each supernode in the inverse, -1 below the top */
  double *inverse, *top_work;
};

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

static void free_top(struct keyway_cholmod *c)
{
  free(c->is_top);
  free(c->super_of);
  free(c->place_of);
  free(c->top_start);
  free(c->inverse);
  free(c->top_work);
  c->is_top = NULL;
  c->super_of = c->place_of = NULL;
  c->top_start = NULL;
  c->inverse = c->top_work = NULL;
}

void keyway_cholmod_finish(void *handle)
{
  struct keyway_cholmod *c = handle;
  if (!c) return;
  free_top(c);
  cholmod_free_dense(&c->x, &c->common);
  cholmod_free_dense(&c->y, &c->common);
  cholmod_free_dense(&c->e, &c->common);
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
  int *post = work + n, *old = work + 5 * (size_t)n;
  if (!work) return -1;
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

/* Plans the factor. `order` lists the unknowns in the order of elimination, 0-based, of which the
 * last m stay the last; NULL leaves it to CHOLMOD's own METIS. Returns CHOLMOD's status, 0 for
 * success. */
int keyway_cholmod_analyse(void *handle, int n, const int *start, const int *used, const int *row,
                           int m, int *order)
{
  struct keyway_cholmod *c = handle;
  cholmod_sparse a = view(n, start, used, row, NULL);
  free_top(c);
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
  if (!cholmod_factorize(&a, c->factor, &c->common)) return c->common.status;
  if (c->common.status == CHOLMOD_NOT_POSDEF) {
    if (c->factor->minor < c->factor->n) *column = ((int *)c->factor->Perm)[c->factor->minor];
    return 1;
  }
  if (c->common.status == CHOLMOD_OK && c->factor->is_super)
    *ratio = smallest_pivot(c->factor, start, values, column);
  return c->common.status;
}

/* Solves for `columns` right-hand sides of length n, in place. Returns 0 for success. */
int keyway_cholmod_solve(void *handle, int n, int columns, double *b)
{
  struct keyway_cholmod *c = handle;
  cholmod_dense rhs;
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
  if (!l->is_super) return 1;
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

static struct keyway_supernodes supernodes_of(const struct keyway_cholmod *c)
{
  const cholmod_factor *l = c->factor;
  struct keyway_supernodes view = {(int)l->nsuper, l->super, l->pi, l->px, l->s, l->x};
  return view;
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
    nodes = supernodes_of(c);
    share = keyway_mark_upper(&nodes, count, column, c->is_upper);
  }
  free(place);
  free(column);
  return share;
}

/* y = L^-1 y, or y = L^-T y, on a part of the supernodes, in the order of elimination. Returns 0
 * for success. */
int keyway_cholmod_substitute(void *handle, int part, int is_forward, int n, double *y)
{
  struct keyway_cholmod *c = handle;
  struct keyway_supernodes nodes = supernodes_of(c);
  if (!c->work) c->work = malloc((c->factor->maxesize + 1) * sizeof *c->work);
  if (!c->work || (part != KEYWAY_WHOLE && !c->is_upper) || n != (int)c->factor->n) return 1;
  if (is_forward)
    keyway_substitute_forward(&nodes, part, c->is_upper, y, c->work);
  else
    keyway_substitute_backward(&nodes, part, c->is_upper, y, c->work);
  return 0;
}

/* Chooses the top of a planned factor by `count` unknowns, 0-based. `entries` are those of its L.
 * Returns 0 for success. */
int keyway_cholmod_choose_top(void *handle, int n, int count, const int *unknown, double *entries)
{
  struct keyway_cholmod *c = handle;
  const int *perm = c->factor->Perm;
  struct keyway_supernodes l;
  int *wanted;
  long used = 0;
  free_top(c);
  if (!c->factor->is_super) return 1;
  l = supernodes_of(c);
  wanted = malloc(((size_t)count + 1) * sizeof *wanted);
  c->is_top = malloc((size_t)l.num_supernodes + 1);
  c->super_of = malloc((size_t)n * sizeof(int));
  c->place_of = malloc((size_t)n * sizeof(int));
  c->top_start = malloc((size_t)l.num_supernodes * sizeof(long));
  c->top_work = malloc((size_t)n * sizeof(double));
  if (!wanted || !c->is_top || !c->super_of || !c->place_of || !c->top_start || !c->top_work) {
    free(wanted);
    free_top(c);
    return -2;
  }
  for (int i = 0; i < n; i++) c->place_of[perm[i]] = i;
  for (int i = 0; i < count; i++) wanted[i] = c->place_of[unknown[i]];
  if (keyway_mark_upper(&l, count, wanted, c->is_top) < 0.0) {
    free(wanted);
    free_top(c);
    return -2;
  }
  free(wanted);
  for (int s = 0; s < l.num_supernodes; s++) {
    int width = l.column[s + 1] - l.column[s];
    for (int j = l.column[s]; j < l.column[s + 1]; j++) c->super_of[j] = s;
    c->top_start[s] = c->is_top[s] ? used : -1;
    if (c->is_top[s]) used += (long)(l.row_start[s + 1] - l.row_start[s]) * width;
  }
  *entries = (double)used;
  return 0;
}

/* Adds L^-1 P b to y for a vector b that is zero but at unknowns of the top. */
void keyway_cholmod_add_to_top(void *handle, int n, const double *b, double *y)
{
  struct keyway_cholmod *c = handle;
  struct keyway_supernodes l = supernodes_of(c);
  double *z = calloc((size_t)n, sizeof *z);
  if (!z) return;
  for (int i = 0; i < n; i++) z[c->place_of[i]] = b[i];
  keyway_substitute_forward(&l, KEYWAY_UPPER, c->is_top, z, c->top_work);
  for (int i = 0; i < n; i++) y[i] += z[i];
  free(z);
}

/* The unknowns of the top in P^T L^-T y; other entries of x stay. */
void keyway_cholmod_solve_top(void *handle, int n, const double *y, double *x)
{
  struct keyway_cholmod *c = handle;
  struct keyway_supernodes l = supernodes_of(c);
  const int *perm = c->factor->Perm;
  double *z = malloc((size_t)n * sizeof *z);
  if (!z) return;
  memcpy(z, y, (size_t)n * sizeof *z);
  keyway_substitute_backward(&l, KEYWAY_UPPER, c->is_top, z, c->top_work);
  for (int j = 0; j < n; j++)
    if (c->is_top[c->super_of[j]]) x[perm[j]] = z[j];
  free(z);
}

/* Inverts the top; `entries` as from choose_top. Returns 0 for success. */
int keyway_cholmod_invert_top(void *handle, double entries)
{
  struct keyway_cholmod *c = handle;
  struct keyway_supernodes l = supernodes_of(c);
  c->inverse = malloc((size_t)entries * sizeof(double));
  if (!c->inverse) return -2;
  return keyway_invert(&l, c->super_of, c->top_start, c->inverse);
}

/* Entries of the inverse of the matrix for pairs of unknowns of the top, 0-based. Returns how many
 * are not known and set to zero, negative without memory. */
int keyway_cholmod_inverse(void *handle, int rows, const int *row, int columns, const int *column,
                           double *block)
{
  struct keyway_cholmod *c = handle;
  struct keyway_supernodes l = supernodes_of(c);
  int *place = malloc(((size_t)rows + (size_t)columns) * sizeof *place), answer;
  if (!place) return -1;
  for (int i = 0; i < rows; i++) place[i] = c->place_of[row[i]];
  for (int i = 0; i < columns; i++) place[rows + i] = c->place_of[column[i]];
  answer = keyway_inverse_entries(&l, c->super_of, c->top_start, c->inverse, rows, place, columns,
                                  place + rows, block);
  free(place);
  return answer;
}

/* Frees the inverse of the top. */
void keyway_cholmod_forget_inverse(void *handle)
{
  struct keyway_cholmod *c = handle;
  free(c->inverse);
  c->inverse = NULL;
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
