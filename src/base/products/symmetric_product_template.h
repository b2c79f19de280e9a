/* y = A x for vectors whose entries of one unknown are ENTRIES; the name is MULTIPLY. */
#define JOIN(name, part) name##part
#define NAME_OF(name, part) JOIN(name, part)
#define ADD_COLUMN NAME_OF(MULTIPLY, _column)
#define ADD_NODE NAME_OF(MULTIPLY, _node)
#define ADD_COLUMNS NAME_OF(MULTIPLY, _columns)

/* One column and its mirror image. */
static inline __attribute__((always_inline)) void
ADD_COLUMN(int length, const int *row, const double *value, const ENTRIES *x, ENTRIES *y, int j)
{
  const ENTRIES own = x[j];
  ENTRIES sum = value[0] * own;
  for (int k = 1; k < length; k++) {
    int i = row[k] - 1;
    sum += value[k] * x[i];
    y[i] += value[k] * own;
  }
  y[j] += sum;
}

/* Three columns of one node, which have the same rows below them: rows are read once for all, and
 * the three rows of a node below are taken together. */
static inline __attribute__((always_inline)) void
ADD_NODE(const int *start, const int *row, const double *value, const ENTRIES *x, ENTRIES *y, int j)
{
  const double *a = value + start[0] - 1, *b = value + start[1] - 1, *c = value + start[2] - 1;
  const int *below = row + start[2];
  const int length = start[3] - start[2] - 1;
  const ENTRIES p = x[j], q = x[j + 1], r = x[j + 2];
  ENTRIES first = a[0] * p + a[1] * q + a[2] * r, second = a[1] * p + b[0] * q + b[1] * r,
          third = a[2] * p + b[1] * q + c[0] * r;
  a += 3, b += 2, c += 1;
  for (int k = 0; k < length;) {
    int i = below[k] - 1;
    __builtin_prefetch(a + 3 * k + ahead, 0, level_2);
    if (k + 2 < length && below[k + 2] == below[k] + 2) {
      first += a[k] * x[i] + a[k + 1] * x[i + 1] + a[k + 2] * x[i + 2];
      second += b[k] * x[i] + b[k + 1] * x[i + 1] + b[k + 2] * x[i + 2];
      third += c[k] * x[i] + c[k + 1] * x[i + 1] + c[k + 2] * x[i + 2];
      y[i] += a[k] * p + b[k] * q + c[k] * r;
      y[i + 1] += a[k + 1] * p + b[k + 1] * q + c[k + 1] * r;
      y[i + 2] += a[k + 2] * p + b[k + 2] * q + c[k + 2] * r;
      k += 3;
    } else {
      first += a[k] * x[i];
      second += b[k] * x[i];
      third += c[k] * x[i];
      y[i] += a[k] * p + b[k] * q + c[k] * r;
      k++;
    }
  }
  y[j] += first;
  y[j + 1] += second;
  y[j + 2] += third;
}

/* Columns `first` to `last` - 1, and their mirror images, which change no row above `first`. */
FOR_EACH_PROCESSOR
void ADD_COLUMNS(int first, int last, const int *start, const int *alike, const int *row,
                 const double *value, const double *x, double *y)
{
  const ENTRIES *from = (const ENTRIES *)x;
  ENTRIES *to = (ENTRIES *)y;
  for (int j = first; j < last;) {
    if (TAKES_NODES && alike[j] >= 3 && j + 3 <= last) {
      ADD_NODE(start + j, row, value, from, to, j);
      j += 3;
    } else {
      ADD_COLUMN(start[j + 1] - start[j], row + start[j] - 1, value + start[j] - 1, from, to, j);
      j++;
    }
  }
}

/* y = A x; alike[j] is the number of columns from j on with the same rows below them. Large
 * matrices are taken in two parts, by one or two threads with the same result. */
void MULTIPLY(int unknowns, int entries, const int *start, const int *alike, const int *row,
              const double *value, const double *x, double *y)
{
  const int middle = first_of_second_part(unknowns, entries, start);
  const size_t length = (size_t)unknowns;
  ENTRIES *to = (ENTRIES *)y, *second = middle < unknowns ? calloc(length, sizeof *second) : NULL;
  const int num_parts = second ? 2 : 1;
#pragma omp parallel for schedule(static) if (num_parts == 2 && omp_get_max_threads() > 1)
  for (int part = 0; part < num_parts; part++) {
    if (part == 0) {
      memset(y, 0, length * sizeof *to);
      ADD_COLUMNS(0, second ? middle : unknowns, start, alike, row, value, x, y);
    } else {
      ADD_COLUMNS(middle, unknowns, start, alike, row, value, x, (double *)second);
    }
  }
  for (int i = middle; second && i < unknowns; i++) to[i] += second[i];
  free(second);
}

#undef JOIN
#undef NAME_OF
#undef ADD_COLUMN
#undef ADD_NODE
#undef ADD_COLUMNS
