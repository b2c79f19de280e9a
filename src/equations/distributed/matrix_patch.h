/* A part of a distributed matrix near some rows, with a factor of its own on one rank. */
#ifndef KEYWAY_MATRIX_PATCH_H
#define KEYWAY_MATRIX_PATCH_H
#include <petscmat.h>

struct matrix_patch {
  IS rows;    /* of the whole matrix, ascending */
  Mat factor; /* L L^T of MUMPS */
};

/* patch_has_no_factor: the part is not positive definite, or memory lacks. */
enum patch_outcome { patch_is_there, patch_too_large, patch_has_no_factor };

/* Takes the rows within some layers of neighbours of `seed`. All ranks call it. A rank keeps the
 * patch that it has where it gives no seeds, and where there are more rows than `most`. */
PetscErrorCode take_patch(Mat matrix, int layers, int most, int count, const int *seed,
                          struct matrix_patch *self, enum patch_outcome *outcome);

PetscErrorCode count_patch_rows(const struct matrix_patch *self, int *count);
PetscErrorCode copy_patch_rows(const struct matrix_patch *self, int *row);

/* Solves for columns over the rows of the patch, in place; for this rank alone. */
PetscErrorCode solve_patch(const struct matrix_patch *self, int sides, double *b);

PetscErrorCode forget_patch(struct matrix_patch *self);
#endif
