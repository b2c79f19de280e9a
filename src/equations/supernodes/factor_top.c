/* The top of a factor of CHOLMOD: the supernodes with chosen unknowns and all their ancestors. */
#include "cholmod_factor.h"
#include <stdlib.h>
#include <string.h>

void keyway_free_top(struct keyway_cholmod *c)
{
  free(c->is_top);
  free(c->super_of);
  free(c->place_of);
  free(c->top_work);
  if (c->factor) keyway_free_inverse((int)c->factor->nsuper, &c->inverse);
  c->is_top = NULL;
  c->super_of = c->place_of = NULL;
  c->top_work = NULL;
}

/* Chooses the top of a planned factor by `count` unknowns, 0-based. Returns 0 for success. */
int keyway_cholmod_choose_top(void *handle, int n, int count, const int *unknown)
{
  struct keyway_cholmod *c = handle;
  const int *perm = c->factor->Perm;
  struct keyway_supernodes l;
  int *wanted;
  keyway_free_top(c);
  if (!c->factor->is_super) return 1;
  l = keyway_supernodes_of(c);
  wanted = malloc(((size_t)count + 1) * sizeof *wanted);
  c->is_top = malloc((size_t)l.num_supernodes + 1);
  c->super_of = malloc((size_t)n * sizeof(int));
  c->place_of = malloc((size_t)n * sizeof(int));
  c->top_work = malloc((size_t)n * sizeof(double));
  if (!wanted || !c->is_top || !c->super_of || !c->place_of || !c->top_work) {
    free(wanted);
    keyway_free_top(c);
    return -2;
  }
  for (int i = 0; i < n; i++) c->place_of[perm[i]] = i;
  for (int i = 0; i < count; i++) wanted[i] = c->place_of[unknown[i]];
  if (keyway_mark_upper(&l, count, wanted, c->is_top) < 0.0) {
    free(wanted);
    keyway_free_top(c);
    return -2;
  }
  free(wanted);
  for (int s = 0; s < l.num_supernodes; s++)
    for (int j = l.column[s]; j < l.column[s + 1]; j++) c->super_of[j] = s;
  return 0;
}

/* Adds L^-1 P b to y for a vector b that is zero but at unknowns of the top. Returns 0 for
 * success. */
int keyway_cholmod_add_to_top(void *handle, int n, const double *b, double *y)
{
  struct keyway_cholmod *c = handle;
  struct keyway_supernodes l = keyway_supernodes_of(c);
  double *z = calloc((size_t)n, sizeof *z);
  if (!z) return -2;
  for (int i = 0; i < n; i++) z[c->place_of[i]] = b[i];
  keyway_substitute_forward(&l, KEYWAY_UPPER, c->is_top, z, c->top_work);
  for (int i = 0; i < n; i++) y[i] += z[i];
  free(z);
  return 0;
}

/* The unknowns of the top in P^T L^-T y; other entries of x stay. Returns 0 for success. */
int keyway_cholmod_solve_top(void *handle, int n, const double *y, double *x)
{
  struct keyway_cholmod *c = handle;
  struct keyway_supernodes l = keyway_supernodes_of(c);
  const int *perm = c->factor->Perm;
  double *z = malloc((size_t)n * sizeof *z);
  if (!z) return -2;
  memcpy(z, y, (size_t)n * sizeof *z);
  keyway_substitute_backward(&l, KEYWAY_UPPER, c->is_top, z, c->top_work);
  for (int j = 0; j < n; j++)
    if (c->is_top[c->super_of[j]]) x[perm[j]] = z[j];
  free(z);
  return 0;
}

/* Starts the inverse of the matrix in the pattern of the top. Returns 0 for success. */
int keyway_cholmod_start_inverse(void *handle)
{
  struct keyway_cholmod *c = handle;
  struct keyway_supernodes l = keyway_supernodes_of(c);
  if (c->single) return 1;
  keyway_free_inverse(l.num_supernodes, &c->inverse);
  return keyway_start_inverse(&l, c->super_of, c->is_top, &c->inverse);
}

/* Adds to the expected uses of some unknowns, 0-based, or takes them away, and then frees what is
 * not used any more. */
void keyway_cholmod_expect(void *handle, int count, const int *unknown, int uses)
{
  struct keyway_cholmod *c = handle;
  struct keyway_supernodes l = keyway_supernodes_of(c);
  for (int i = 0; i < count; i++) c->inverse.pending[c->super_of[c->place_of[unknown[i]]]] += uses;
  if (uses < 0) keyway_release_blocks(&l, c->super_of, &c->inverse);
}

/* The first supernode with some unknowns, 0-based. */
int keyway_cholmod_first_super(void *handle, int count, const int *unknown)
{
  struct keyway_cholmod *c = handle;
  int first = (int)c->factor->nsuper;
  for (int i = 0; i < count; i++) {
    int s = c->super_of[c->place_of[unknown[i]]];
    if (s < first) first = s;
  }
  return first;
}

/* Inverts the top down to a supernode. Returns 0 for success. */
int keyway_cholmod_invert_top(void *handle, int first)
{
  struct keyway_cholmod *c = handle;
  struct keyway_supernodes l = keyway_supernodes_of(c);
  return keyway_invert_down_to(&l, c->super_of, c->is_top, first, &c->inverse);
}

/* Entries of the inverse of the matrix for pairs of unknowns of the top, 0-based. Returns how many
 * are not known and set to zero, negative without memory. */
int keyway_cholmod_inverse(void *handle, int rows, const int *row, int columns, const int *column,
                           double *block)
{
  struct keyway_cholmod *c = handle;
  struct keyway_supernodes l = keyway_supernodes_of(c);
  int *place = malloc(((size_t)rows + (size_t)columns) * sizeof *place), answer;
  if (!place) return -1;
  for (int i = 0; i < rows; i++) place[i] = c->place_of[row[i]];
  for (int i = 0; i < columns; i++) place[rows + i] = c->place_of[column[i]];
  answer = keyway_inverse_entries(&l, c->super_of, &c->inverse, rows, place, columns, place + rows,
                                  block);
  free(place);
  return answer;
}

/* Frees the inverse of the top. */
void keyway_cholmod_forget_inverse(void *handle)
{
  struct keyway_cholmod *c = handle;
  keyway_free_inverse((int)c->factor->nsuper, &c->inverse);
}
