/* The time of a substitution is that of reading the factor from memory: four columns are used at
 * once, so that t stays in registers and in the nearest cache. */
#include "single_columns.h"
#include "../../base/math/each_processor.h"
#include <stddef.h>

/* Asks for values that are needed soon: blocks are short, and the processor is slow to see that
 * they follow one another in memory. Addresses outside of the factor have no effect. */
static inline void fetch(const float *value, int count)
{
  enum { line = 16, level_2 = 2 };
  for (int k = 0; k < count; k += line) __builtin_prefetch(value + k, 0, level_2);
}

FOR_EACH_PROCESSOR
void keyway_forward_columns(int width, int length, const float *value, double *t)
{
  int j = 0;
  for (; j + 4 <= width; j += 4) {
    const float *a = value + (size_t)j * (size_t)length, *b = a + length, *c = b + length;
    const float *d = c + length;
    double p = t[j] / a[j];
    double q = (t[j + 1] - a[j + 1] * p) / b[j + 1];
    double r = (t[j + 2] - a[j + 2] * p - b[j + 2] * q) / c[j + 2];
    double s = (t[j + 3] - a[j + 3] * p - b[j + 3] * q - c[j + 3] * r) / d[j + 3];
    t[j] = p;
    t[j + 1] = q;
    t[j + 2] = r;
    t[j + 3] = s;
    fetch(value + (size_t)(j + 4) * (size_t)length, 4 * length);
#pragma omp simd
    for (int i = j + 4; i < length; i++) t[i] -= a[i] * p + b[i] * q + (c[i] * r + d[i] * s);
  }
  for (; j < width; j++) {
    const float *a = value + (size_t)j * (size_t)length;
    double p = t[j] /= a[j];
#pragma omp simd
    for (int i = j + 1; i < length; i++) t[i] -= a[i] * p;
  }
}

FOR_EACH_PROCESSOR
void keyway_backward_columns(int width, int length, const float *value, double *t)
{
  int j = width;
  for (; j % 4 != 0; j--) {
    const float *a = value + (size_t)(j - 1) * (size_t)length;
    double p = 0.0;
#pragma omp simd reduction(+ : p)
    for (int i = j; i < length; i++) p += a[i] * t[i];
    t[j - 1] = (t[j - 1] - p) / a[j - 1];
  }
  for (j -= 4; j >= 0; j -= 4) {
    const float *a = value + (size_t)j * (size_t)length, *b = a + length, *c = b + length;
    const float *d = c + length;
    double p = 0.0, q = 0.0, r = 0.0, s = 0.0;
    fetch(a - (size_t)4 * (size_t)length, 4 * length);
#pragma omp simd reduction(+ : p, q, r, s)
    for (int i = j + 4; i < length; i++) {
      p += a[i] * t[i];
      q += b[i] * t[i];
      r += c[i] * t[i];
      s += d[i] * t[i];
    }
    t[j + 3] = (t[j + 3] - s) / d[j + 3];
    t[j + 2] = (t[j + 2] - r - c[j + 3] * t[j + 3]) / c[j + 2];
    t[j + 1] = (t[j + 1] - q - b[j + 2] * t[j + 2] - b[j + 3] * t[j + 3]) / b[j + 1];
    t[j] = (t[j] - p - a[j + 1] * t[j + 1] - a[j + 2] * t[j + 2] - a[j + 3] * t[j + 3]) / a[j];
  }
}
