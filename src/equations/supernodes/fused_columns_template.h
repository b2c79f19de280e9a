/* The procedures of fused_columns.h for values of the type VALUE, with names from OF_PRECISION. */

/* Asks for some rows of four columns. Addresses outside of the factor have no effect. */
static inline void OF_PRECISION(fetch)(const VALUE *value, size_t length)
{
  for (int column = 0; column < 4; column++, value += length)
    for (size_t k = 0; k < rows_at_once; k += line / sizeof *value)
      __builtin_prefetch(value + k, 0, level_2);
}

FOR_EACH_PROCESSOR
void OF_PRECISION(keyway_forward)(int width, int length, const VALUE *value, double *t)
{
  const size_t n = (size_t)length;
  const int is_ahead = asks_ahead(sizeof *value);
  int j = 0;
  for (; j + 4 <= width; j += 4) {
    const VALUE *a = value + (size_t)j * n, *b = a + n, *c = b + n, *d = c + n;
    double p = t[j] / a[j];
    double q = (t[j + 1] - a[j + 1] * p) / b[j + 1];
    double r = (t[j + 2] - a[j + 2] * p - b[j + 2] * q) / c[j + 2];
    double s = (t[j + 3] - a[j + 3] * p - b[j + 3] * q - c[j + 3] * r) / d[j + 3];
    int i = j + 4;
    t[j] = p;
    t[j + 1] = q;
    t[j + 2] = r;
    t[j + 3] = s;
    for (; i + rows_at_once <= length; i += rows_at_once) {
      if (is_ahead) OF_PRECISION(fetch)(d + n + i, n);
#pragma omp simd
      for (int k = i; k < i + rows_at_once; k++)
        t[k] -= a[k] * p + b[k] * q + (c[k] * r + d[k] * s);
    }
#pragma omp simd
    for (int k = i; k < length; k++) t[k] -= a[k] * p + b[k] * q + (c[k] * r + d[k] * s);
  }
  for (; j < width; j++) {
    const VALUE *a = value + (size_t)j * n;
    double p = t[j] /= a[j];
#pragma omp simd
    for (int i = j + 1; i < length; i++) t[i] -= a[i] * p;
  }
}

FOR_EACH_PROCESSOR
void OF_PRECISION(keyway_backward)(int width, int length, const VALUE *value, double *t)
{
  const size_t n = (size_t)length;
  const int is_ahead = asks_ahead(sizeof *value);
  int j = width;
  for (; j % 4 != 0; j--) {
    const VALUE *a = value + (size_t)(j - 1) * n;
    double p = 0.0;
#pragma omp simd reduction(+ : p)
    for (int i = j; i < length; i++) p += a[i] * t[i];
    t[j - 1] = (t[j - 1] - p) / a[j - 1];
  }
  for (j -= 4; j >= 0; j -= 4) {
    const VALUE *a = value + (size_t)j * n, *b = a + n, *c = b + n, *d = c + n;
    double p = 0.0, q = 0.0, r = 0.0, s = 0.0;
    int last = j + 4;
    for (int i = last; i < length; i = last) {
      last = i + rows_at_once < length ? i + rows_at_once : length;
      if (is_ahead) OF_PRECISION(fetch)(a - 4 * n + i, n);
#pragma omp simd reduction(+ : p, q, r, s)
      for (int k = i; k < last; k++) {
        p += a[k] * t[k];
        q += b[k] * t[k];
        r += c[k] * t[k];
        s += d[k] * t[k];
      }
    }
    t[j + 3] = (t[j + 3] - s) / d[j + 3];
    t[j + 2] = (t[j + 2] - r - c[j + 3] * t[j + 3]) / c[j + 2];
    t[j + 1] = (t[j + 1] - q - b[j + 2] * t[j + 2] - b[j + 3] * t[j + 3]) / b[j + 1];
    t[j] = (t[j] - p - a[j + 1] * t[j + 1] - a[j + 2] * t[j + 2] - a[j + 3] * t[j + 3]) / a[j];
  }
}
