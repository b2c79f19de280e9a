/* Products of matrices in double or single precision with vectors in double precision, sums in
 * double precision. Their time is that of reading the matrix: four columns are used at once. */
#include "../math/each_processor.h"
#include <stddef.h>

#define VALUE double
#define ADD_PRODUCT keyway_add_double_product
#include "fused_products_template.h"
#undef VALUE
#undef ADD_PRODUCT

#define VALUE float
#define ADD_PRODUCT keyway_add_product
#include "fused_products_template.h"

/* y = A^T x. */
FOR_EACH_PROCESSOR
void keyway_transposed_product(int rows, int columns, const float *value, const double *x,
                               double *y)
{
  int j = 0;
  for (; j + 4 <= columns; j += 4) {
    const float *a = value + (size_t)j * (size_t)rows, *b = a + rows, *c = b + rows, *d = c + rows;
    double p = 0.0, q = 0.0, r = 0.0, s = 0.0;
#pragma omp simd reduction(+ : p, q, r, s)
    for (int i = 0; i < rows; i++) {
      p += a[i] * x[i];
      q += b[i] * x[i];
      r += c[i] * x[i];
      s += d[i] * x[i];
    }
    y[j] = p;
    y[j + 1] = q;
    y[j + 2] = r;
    y[j + 3] = s;
  }
  for (; j < columns; j++) {
    const float *a = value + (size_t)j * (size_t)rows;
    double p = 0.0;
#pragma omp simd reduction(+ : p)
    for (int i = 0; i < rows; i++) p += a[i] * x[i];
    y[j] = p;
  }
}
