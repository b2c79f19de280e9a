/* A factor of CHOLMOD in single precision: a substitution, which reads the factor and does little
 * else, takes half of the time. Either its lower part takes the place of the one in double precision,
 * which needs half of the memory, or a copy of the whole factor stands beside it. */
#include "cholmod_factor.h"
#include <stdlib.h>
#include <string.h>

void keyway_free_single(struct keyway_cholmod *c)
{
  cholmod_free(c->num_single, sizeof(float), c->single, &c->common);
  free(c->rest);
  free(c->part_start);
  free(c->copy);
  free(c->copy_start);
  c->single = NULL;
  c->copy = NULL;
  c->copy_start = NULL;
  c->rest = NULL;
  c->part_start = NULL;
}

struct keyway_supernodes keyway_supernodes_of(const struct keyway_cholmod *c)
{
  const cholmod_factor *l = c->factor;
  struct keyway_supernodes view = {(int)l->nsuper, l->super, l->pi, l->px, l->s,
                                   c->single ? c->rest : l->x, c->single, c->part_start};
  return view;
}

/* Copies the blocks that stay in double precision. Returns 0 for success. */
static int copy_rest(struct keyway_cholmod *c, const char *is_double)
{
  const cholmod_factor *l = c->factor;
  const int *start = l->px;
  long used = 0, used_single = 0;
  c->part_start = malloc((l->nsuper + 1) * sizeof *c->part_start);
  if (!c->part_start) return 1;
  for (size_t s = 0; s < l->nsuper; s++) {
    long *place = is_double[s] ? &used : &used_single;
    c->part_start[s] = is_double[s] ? -1 - used : used_single;
    *place += start[s + 1] - start[s];
  }
  c->rest = malloc(((size_t)used + 1) * sizeof *c->rest);
  if (!c->rest) return 1;
  for (size_t s = 0; s < l->nsuper; s++)
    if (is_double[s])
      memcpy(c->rest - c->part_start[s] - 1, (double *)l->x + start[s],
             (size_t)(start[s + 1] - start[s]) * sizeof(double));
  return 0;
}

/* Rounds the other blocks in place, from the first to the last, and gives back what is left of
 * their memory. */
static void round_blocks(struct keyway_cholmod *c, const char *is_double)
{
  cholmod_factor *l = c->factor;
  const int *start = l->px;
  size_t used = 0;
  char *bytes = l->x;
  for (size_t s = 0; s < l->nsuper; s++) {
    if (is_double[s]) continue;
    for (long k = start[s]; k < start[s + 1]; k++, used++) {
      double exact;
      float rounded;
      memcpy(&exact, bytes + (size_t)k * sizeof exact, sizeof exact);
      rounded = (float)exact;
      memcpy(bytes + used * sizeof rounded, &rounded, sizeof rounded);
    }
  }
  c->num_single = 2 * l->xsize;
  c->single = cholmod_realloc(used + 1, sizeof(float), l->x, &c->num_single, &c->common);
  l->x = NULL; /* a plan again, as cholmod_change_factor leaves it */
  l->xtype = CHOLMOD_PATTERN;
}

/* Keeps the factor in single precision but for the chosen unknowns, 0-based, and all that follow
 * them. Returns 0 for success. */
int keyway_cholmod_round(void *handle, int n, int count, const int *unknown)
{
  struct keyway_cholmod *c = handle;
  const int *perm = c->factor->Perm;
  struct keyway_supernodes nodes;
  int *place = malloc((size_t)n * sizeof *place);
  int *column = malloc(((size_t)count + 1) * sizeof *column), status = 1;
  char *is_double = malloc(c->factor->nsuper + 1);
  if (place && column && is_double && c->factor->is_super && c->factor->x) {
    nodes = keyway_supernodes_of(c);
    for (int k = 0; k < n; k++) place[perm[k]] = k;
    for (int k = 0; k < count; k++) column[k] = place[unknown[k]];
    if (keyway_mark_upper(&nodes, count, column, is_double) >= 0.0)
      status = copy_rest(c, is_double);
    if (status == 0) round_blocks(c, is_double);
  }
  free(place);
  free(column);
  free(is_double);
  return status;
}

struct keyway_supernodes keyway_supernodes_of_copy(const struct keyway_cholmod *c)
{
  const cholmod_factor *l = c->factor;
  struct keyway_supernodes view = {(int)l->nsuper, l->super, l->pi, l->px, l->s,
                                   NULL, c->copy, c->copy_start};
  return view;
}

/* Copies the factor. Returns 0 for success; without memory there is no copy. */
int keyway_cholmod_copy(void *handle)
{
  struct keyway_cholmod *c = handle;
  const cholmod_factor *l = c->factor;
  const int *start = l->px;
  const double *value = l->x;
  keyway_free_single(c);
  if (!l->is_super || !value) return 1;
  c->copy = malloc((l->xsize + 1) * sizeof *c->copy);
  c->copy_start = malloc((l->nsuper + 1) * sizeof *c->copy_start);
  if (!c->copy || !c->copy_start) {
    keyway_free_single(c);
    return 1;
  }
  for (size_t s = 0; s < l->nsuper; s++) c->copy_start[s] = start[s];
#pragma omp parallel for
  for (size_t k = 0; k < l->xsize; k++) c->copy[k] = (float)value[k];
  return 0;
}
