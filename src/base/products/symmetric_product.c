/* Products of a sparse symmetric matrix with one, two or eight vectors: the matrix is read once.
 *
 * The matrix is its lower triangle by columns, the diagonal first, with places from 1. The entries
 * of an unknown in all vectors are side by side. */
#include "../math/each_processor.h"
#include <omp.h>
#include <stdlib.h>
#include <string.h>

/* Entries of the matrix after the present ones that memory sends meanwhile. */
enum { ahead = 512, level_2 = 2 };

/* Smaller matrices are taken in one part: threads are not worth their start. */
enum { fewest_for_parts = 400000 };

/* First column of the second part: half of the entries stand before it. `unknowns` where there is
 * one part. */
static int first_of_second_part(int unknowns, int entries, const int *start)
{
  int low = 0, high = unknowns;
  if (entries < fewest_for_parts) return unknowns;
  while (low < high) {
    int column = low + (high - low) / 2;
    if (start[column] - 1 < entries / 2) low = column + 1;
    else high = column;
  }
  return low;
}

/* The entries of an unknown in all vectors; aligned as the numbers of Fortran are. */
typedef double pair __attribute__((vector_size(16), aligned(8), may_alias));
typedef double eight __attribute__((vector_size(64), aligned(8), may_alias));

#define MULTIPLY keyway_multiply_one
#define ENTRIES double
#define TAKES_NODES 1
#include "symmetric_product_template.h"
#undef MULTIPLY
#undef ENTRIES

#define MULTIPLY keyway_multiply_two
#define ENTRIES pair
#include "symmetric_product_template.h"
#undef MULTIPLY
#undef ENTRIES
#undef TAKES_NODES

/* Three columns of eight vectors would be more than the registers hold. */
#define MULTIPLY keyway_multiply_eight
#define ENTRIES eight
#define TAKES_NODES 0
#include "symmetric_product_template.h"
