/* The upper triangle of a symmetric matrix in blocks of 3 x 3, summed over the ranks. */
#ifndef KEYWAY_BLOCK_MATRIX_H
#define KEYWAY_BLOCK_MATRIX_H
#include <petscmat.h>

#include "block_list.h"

/* Makes the matrix of all blocks in the lists of all ranks. `rows` are the own ones; a block is in
 * the upper triangle. */
PetscErrorCode plan_blocks(int rows, const struct block_list *list, Mat *blocks);

/* Sums the blocks of all ranks, in the order of the ranks: nine values of each, row by row. */
PetscErrorCode sum_blocks(const struct block_list *list, const double *values, Mat blocks);

/* Copies both triangles to a matrix by rows, for what PETSc cannot do with blocks. */
PetscErrorCode copy_to_rows(Mat blocks, Mat *rows);
#endif
