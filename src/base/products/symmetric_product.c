/* Products of a sparse symmetric matrix with one, two or eight vectors: the matrix is read once.
 *
 * The matrix is its lower triangle by columns, the diagonal first, with places from 1. The entries
 * of an unknown in all vectors are side by side. */
#include "../math/each_processor.h"
#include <stddef.h>

#define ALWAYS_INLINE static inline __attribute__((always_inline))

/* y += entry x for the entries of one unknown */
ALWAYS_INLINE void add_product(int vectors, double entry, const double *restrict x,
                               double *restrict y)
{
#pragma GCC ivdep
  for (int c = 0; c < vectors; c++) y[c] += entry * x[c];
}

/* One column and its mirror image. */
ALWAYS_INLINE void add_column(int vectors, int length, const int *row, const double *value,
                              const double *x, double *y, const double *own, double *own_y)
{
  double sum[8] = {0.0};
  add_product(vectors, value[0], own, sum);
  for (int k = 1; k < length; k++) {
    size_t i = (size_t)(row[k] - 1) * (size_t)vectors;
    add_product(vectors, value[k], x + i, sum);
    add_product(vectors, value[k], own, y + i);
  }
  add_product(vectors, 1.0, sum, own_y);
}

/* Three columns of one node, which have the same rows below them: rows are read once for all. */
ALWAYS_INLINE void add_node(int vectors, const int *start, const int *row, const double *value,
                            const double *x, double *y, const double *own, double *own_y)
{
  const double *a = value + start[0] - 1, *b = value + start[1] - 1, *c = value + start[2] - 1;
  const double *q1 = own, *q2 = own + vectors, *q3 = own + 2 * vectors;
  const int *below = row + start[2];
  int length = start[3] - start[2] - 1;
  double sum[3][8] = {{0.0}};
  const double own_block[3][3] = {{a[0], a[1], a[2]}, {a[1], b[0], b[1]}, {a[2], b[1], c[0]}};
  for (int r = 0; r < 3; r++)
    for (int q = 0; q < 3; q++) add_product(vectors, own_block[r][q], own + q * vectors, sum[r]);
  a += 3, b += 2, c += 1;
  for (int k = 0; k < length; k++) {
    size_t i = (size_t)(below[k] - 1) * (size_t)vectors;
    add_product(vectors, a[k], x + i, sum[0]);
    add_product(vectors, b[k], x + i, sum[1]);
    add_product(vectors, c[k], x + i, sum[2]);
    double moved[8] = {0.0};
    add_product(vectors, a[k], q1, moved);
    add_product(vectors, b[k], q2, moved);
    add_product(vectors, c[k], q3, moved);
    add_product(vectors, 1.0, moved, y + i);
  }
  for (int r = 0; r < 3; r++) add_product(vectors, 1.0, sum[r], own_y + r * vectors);
}

/* y = A x; alike[j] is the number of columns from j on with the same rows below them. Three columns
 * of eight vectors would be more than the registers hold. */
ALWAYS_INLINE void multiply(int vectors, int unknowns, const int *start, const int *alike,
                            const int *row, const double *value, const double *x, double *y)
{
  for (size_t i = 0; i < (size_t)unknowns * (size_t)vectors; i++) y[i] = 0.0;
  for (int j = 0; j < unknowns;) {
    size_t i = (size_t)j * (size_t)vectors;
    int first = start[j] - 1;
    if (vectors < 8 && alike[j] >= 3) {
      add_node(vectors, start + j, row, value, x, y, x + i, y + i);
      j += 3;
    } else {
      add_column(vectors, start[j + 1] - start[j], row + first, value + first, x, y, x + i, y + i);
      j++;
    }
  }
}

FOR_EACH_PROCESSOR
void keyway_multiply_one(int unknowns, int entries, const int *start, const int *alike,
                         const int *row, const double *value, const double *x, double *y)
{
  (void)entries;
  multiply(1, unknowns, start, alike, row, value, x, y);
}

FOR_EACH_PROCESSOR
void keyway_multiply_two(int unknowns, int entries, const int *start, const int *alike,
                         const int *row, const double *value, const double *x, double *y)
{
  (void)entries;
  multiply(2, unknowns, start, alike, row, value, x, y);
}

FOR_EACH_PROCESSOR
void keyway_multiply_eight(int unknowns, int entries, const int *start, const int *alike,
                           const int *row, const double *value, const double *x, double *y)
{
  (void)entries;
  multiply(8, unknowns, start, alike, row, value, x, y);
}
