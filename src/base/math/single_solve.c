/* Solution with a dense factor in single precision. Four columns are used at once: the BLAS takes
 * two to three times as long for the small factors of groups of joint points. */
#include "each_processor.h"
#include <stddef.h>

/* x = L^-1 x; L has a unit diagonal. */
FOR_EACH_PROCESSOR
void keyway_solve_unit_lower(int rows, const float *value, float *x)
{
  const size_t n = (size_t)rows;
  int j = 0;
  for (; j + 4 <= rows; j += 4) {
    const float *a = value + (size_t)j * n, *b = a + n, *c = b + n, *d = c + n;
    float p = x[j], q = x[j + 1] - a[j + 1] * p;
    float r = x[j + 2] - a[j + 2] * p - b[j + 2] * q;
    float s = x[j + 3] - a[j + 3] * p - b[j + 3] * q - c[j + 3] * r;
    x[j + 1] = q;
    x[j + 2] = r;
    x[j + 3] = s;
#pragma omp simd
    for (int i = j + 4; i < rows; i++) x[i] -= a[i] * p + b[i] * q + (c[i] * r + d[i] * s);
  }
  for (; j < rows; j++)
    for (int i = j + 1; i < rows; i++) x[i] -= value[(size_t)j * n + (size_t)i] * x[j];
}

/* x = U^-1 x, from the last column to the first. */
FOR_EACH_PROCESSOR
void keyway_solve_upper(int rows, const float *value, float *x)
{
  const size_t n = (size_t)rows;
  int j = rows;
  for (; j % 4 != 0; j--) {
    const float *a = value + (size_t)(j - 1) * n;
    float p = x[j - 1] /= a[j - 1];
#pragma omp simd
    for (int i = 0; i < j - 1; i++) x[i] -= a[i] * p;
  }
  for (j -= 4; j >= 0; j -= 4) {
    const float *a = value + (size_t)j * n, *b = a + n, *c = b + n, *d = c + n;
    float s = x[j + 3] / d[j + 3];
    float r = (x[j + 2] - d[j + 2] * s) / c[j + 2];
    float q = (x[j + 1] - d[j + 1] * s - c[j + 1] * r) / b[j + 1];
    float p = (x[j] - d[j] * s - c[j] * r - b[j] * q) / a[j];
    x[j] = p;
    x[j + 1] = q;
    x[j + 2] = r;
    x[j + 3] = s;
#pragma omp simd
    for (int i = 0; i < j; i++) x[i] -= a[i] * p + b[i] * q + (c[i] * r + d[i] * s);
  }
}
