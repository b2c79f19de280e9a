/* Forward and backward substitution with the supernodes of a factor L L^T, all of them or a part.
 *
 * The solution of L L^T x = b for the columns of the upper part needs the upper part alone, once
 * the lower part has been eliminated from b: the upper part holds, with a column, all columns that
 * follow it in the elimination tree (Liu, SIAM J. Matrix Anal. Appl. 11, 1990, 134-172). */
#include "supernodal_solve.h"
#include "fused_columns.h"
#include <stdlib.h>
#include <string.h>

double keyway_mark_upper(const struct keyway_supernodes *l, int count, const int *column,
                         char *is_upper)
{
  int n = l->column[l->num_supernodes], s = 0;
  double upper = 0.0;
  int *owner = malloc((size_t)n * sizeof *owner); /* supernode of each column */
  memset(is_upper, 0, (size_t)l->num_supernodes);
  if (!owner) return -1.0;
  for (int k = 0; k < n; k++) {
    while (l->column[s + 1] <= k) s++;
    owner[k] = s;
  }
  for (int k = 0; k < count; k++) is_upper[owner[column[k]]] = 1;
  for (s = 0; s < l->num_supernodes; s++) {
    int width = l->column[s + 1] - l->column[s], length = l->row_start[s + 1] - l->row_start[s];
    if (!is_upper[s]) continue;
    upper += (double)width * length;
    if (length > width) is_upper[owner[l->row[l->row_start[s] + width]]] = 1;
  }
  free(owner);
  return upper / (double)l->value_start[l->num_supernodes];
}

int keyway_is_in_part(int s, enum keyway_part part, const char *is_upper)
{
  return part == KEYWAY_WHOLE || is_upper[s] == (part == KEYWAY_UPPER);
}

/* The values of a supernode in double precision, NULL where they are in single precision. */
static const double *double_values(const struct keyway_supernodes *l, int s)
{
  if (!l->single) return l->value + l->value_start[s];
  return l->part_start[s] < 0 ? l->value - l->part_start[s] - 1 : NULL;
}

void keyway_forward_one(const struct keyway_supernodes *l, int s, double *y, double *work)
{
  int first = l->column[s], width = l->column[s + 1] - first;
  int length = l->row_start[s + 1] - l->row_start[s];
  const double *value = double_values(l, s);
  memcpy(work, y + first, (size_t)width * sizeof *y);
  memset(work + width, 0, (size_t)(length - width) * sizeof *y);
  if (value)
    keyway_forward_double(width, length, value, work);
  else
    keyway_forward_single(width, length, l->single + l->part_start[s], work);
  memcpy(y + first, work, (size_t)width * sizeof *y);
}

void keyway_backward_one(const struct keyway_supernodes *l, int s, double *y, double *work)
{
  int first = l->column[s], width = l->column[s + 1] - first;
  int length = l->row_start[s + 1] - l->row_start[s];
  const int *row = l->row + l->row_start[s];
  const double *value = double_values(l, s);
  for (int i = 0; i < length; i++) work[i] = y[row[i]];
  if (value)
    keyway_backward_double(width, length, value, work);
  else
    keyway_backward_single(width, length, l->single + l->part_start[s], work);
  memcpy(y + first, work, (size_t)width * sizeof *y);
}

void keyway_forward_and_add(const struct keyway_supernodes *l, int s, double *y, double *work)
{
  int length = l->row_start[s + 1] - l->row_start[s];
  const int *row = l->row + l->row_start[s];
  keyway_forward_one(l, s, y, work);
  for (int i = l->column[s + 1] - l->column[s]; i < length; i++) y[row[i]] += work[i];
}

void keyway_substitute_forward(const struct keyway_supernodes *l, enum keyway_part part,
                               const char *is_upper, double *y, double *work)
{
  for (int s = 0; s < l->num_supernodes; s++)
    if (keyway_is_in_part(s, part, is_upper)) keyway_forward_and_add(l, s, y, work);
}

void keyway_substitute_backward(const struct keyway_supernodes *l, enum keyway_part part,
                                const char *is_upper, double *y, double *work)
{
  for (int s = l->num_supernodes - 1; s >= 0; s--)
    if (keyway_is_in_part(s, part, is_upper)) keyway_backward_one(l, s, y, work);
}
