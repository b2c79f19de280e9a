/* The upper triangle of a symmetric matrix in blocks of 3 x 3. */
#ifndef KEYWAY_BLOCK_MATRIX_H
#define KEYWAY_BLOCK_MATRIX_H
#include <petscmat.h>

/* Copies a matrix by rows; *blocks is made where it is NULL, and keeps its pattern. */
PetscErrorCode copy_to_blocks(Mat rows, Mat *blocks);
#endif
