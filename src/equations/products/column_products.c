/* Products of a sparse symmetric matrix with eight vectors at once: the matrix is read once. */
#include "../../base/math/each_processor.h"
#include <stddef.h>

enum { COLUMNS = 8 };

/* y = A x with the lower triangle of A by columns, the diagonal first, places from 1; x and y hold
 * the entries of an unknown side by side. */
FOR_EACH_PROCESSOR
void keyway_multiply_eight(int unknowns, int entries, const int *start, const int *row,
                           const double *value, const double *x, double *y)
{
  (void)entries;
  for (size_t i = 0; i < (size_t)unknowns * COLUMNS; i++) y[i] = 0.0;
  for (int j = 0; j < unknowns; j++) {
    const double *own = x + (size_t)j * COLUMNS;
    double sum[COLUMNS];
    int k = start[j] - 1;
    for (int c = 0; c < COLUMNS; c++) sum[c] = value[k] * own[c];
    for (k++; k < start[j + 1] - 1; k++) {
      const double *other = x + (size_t)(row[k] - 1) * COLUMNS;
      double *moved = y + (size_t)(row[k] - 1) * COLUMNS, entry = value[k];
#pragma omp simd
      for (int c = 0; c < COLUMNS; c++) {
        sum[c] += entry * other[c];
        moved[c] += entry * own[c];
      }
    }
    for (int c = 0; c < COLUMNS; c++) y[(size_t)j * COLUMNS + (size_t)c] += sum[c];
  }
}
