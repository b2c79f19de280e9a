/* y = y + A x with A by columns, of the type VALUE; the name comes from ADD_PRODUCT. */
FOR_EACH_PROCESSOR
void ADD_PRODUCT(int rows, int columns, const VALUE *value, const double *x, double *y)
{
  int j = 0;
  for (; j + 4 <= columns; j += 4) {
    const VALUE *a = value + (size_t)j * (size_t)rows, *b = a + rows, *c = b + rows, *d = c + rows;
    double p = x[j], q = x[j + 1], r = x[j + 2], s = x[j + 3];
#pragma omp simd
    for (int i = 0; i < rows; i++) y[i] += a[i] * p + b[i] * q + (c[i] * r + d[i] * s);
  }
  for (; j < columns; j++) {
    const VALUE *a = value + (size_t)j * (size_t)rows;
    double p = x[j];
#pragma omp simd
    for (int i = 0; i < rows; i++) y[i] += a[i] * p;
  }
}
