/* Rows outside of a patch do not move: a force deep in the patch hardly moves them where inertia
 * screens it. */
#include "matrix_patch.h"

#include <string.h>

/* Room that MUMPS gets beyond its estimate [%]: ICNTL(14). */
enum { icntl_room = 14, room = 100 };

PetscErrorCode forget_patch(struct matrix_patch *self)
{
  PetscFunctionBegin;
  PetscCall(ISDestroy(&self->rows));
  PetscCall(MatDestroy(&self->factor));
  PetscFunctionReturn(0);
}

/* L L^T of a matrix of this rank. */
static PetscErrorCode factor_part(Mat part, Mat *both, enum patch_outcome *outcome)
{
  MatFactorInfo choices;
  MatFactorError error;
  PetscFunctionBegin;
  PetscCall(MatSetOption(part, MAT_SPD, PETSC_TRUE));
  PetscCall(MatGetFactor(part, MATSOLVERMUMPS, MAT_FACTOR_CHOLESKY, both));
  PetscCall(MatMumpsSetIcntl(*both, icntl_room, room));
  PetscCall(MatFactorInfoInitialize(&choices));
  PetscCall(MatCholeskyFactorSymbolic(*both, part, NULL, &choices));
  PetscCall(MatCholeskyFactorNumeric(*both, part, &choices));
  PetscCall(MatFactorGetError(*both, &error));
  if (error != MAT_FACTOR_NOERROR) *outcome = patch_has_no_factor;
  PetscFunctionReturn(0);
}

/* The first rows of the matrix: a part for a rank that needs none. */
static PetscErrorCode take_first_rows(Mat matrix, IS *rows)
{
  PetscInt size;
  PetscFunctionBegin;
  PetscCall(MatGetBlockSize(matrix, &size));
  PetscCall(ISCreateStride(PETSC_COMM_SELF, size, 0, 1, rows));
  PetscFunctionReturn(0);
}

/* The rows within some layers of neighbours of the seed, ascending. */
static PetscErrorCode grow_rows(Mat matrix, int layers, int count, const int *seed, IS *rows)
{
  PetscFunctionBegin;
  if (count > 0) {
    PetscCall(ISCreateGeneral(PETSC_COMM_SELF, count, seed, PETSC_COPY_VALUES, rows));
    PetscCall(ISSortRemoveDups(*rows));
  } else {
    PetscCall(take_first_rows(matrix, rows));
  }
  PetscCall(MatIncreaseOverlap(matrix, 1, rows, layers));
  PetscCall(ISSort(*rows));
  PetscFunctionReturn(0);
}

/* PETSc waits for ever where some ranks take a part of a symmetric matrix and others none: ranks
 * without a new patch take a part at the first rows, and forget it. */
PetscErrorCode take_patch(Mat matrix, int layers, int most, int count, const int *seed,
                          struct matrix_patch *self, enum patch_outcome *outcome)
{
  IS near;
  Mat *part;
  PetscInt size;
  int is_taken;
  PetscFunctionBegin;
  PetscCall(grow_rows(matrix, layers, count, seed, &near));
  PetscCall(ISGetLocalSize(near, &size));
  *outcome = count > 0 && size > most ? patch_too_large : patch_is_there;
  is_taken = count > 0 && size <= most;
  if (!is_taken) {
    PetscCall(ISDestroy(&near));
    PetscCall(take_first_rows(matrix, &near));
  }
  PetscCall(MatCreateSubMatrices(matrix, 1, &near, &near, MAT_INITIAL_MATRIX, &part));
  if (is_taken) {
    PetscCall(forget_patch(self));
    self->rows = near;
    PetscCall(factor_part(part[0], &self->factor, outcome));
  } else {
    PetscCall(ISDestroy(&near));
  }
  PetscCall(MatDestroySubMatrices(1, &part));
  PetscFunctionReturn(0);
}

PetscErrorCode count_patch_rows(const struct matrix_patch *self, int *count)
{
  PetscInt size = 0;
  PetscFunctionBegin;
  if (self->rows) PetscCall(ISGetLocalSize(self->rows, &size));
  *count = size;
  PetscFunctionReturn(0);
}

PetscErrorCode copy_patch_rows(const struct matrix_patch *self, int *row)
{
  const PetscInt *own;
  PetscInt size;
  PetscFunctionBegin;
  PetscCall(ISGetLocalSize(self->rows, &size));
  PetscCall(ISGetIndices(self->rows, &own));
  memcpy(row, own, size * sizeof *row);
  PetscCall(ISRestoreIndices(self->rows, &own));
  PetscFunctionReturn(0);
}

PetscErrorCode solve_patch(const struct matrix_patch *self, int sides, double *b)
{
  Mat right, left;
  const PetscScalar *x;
  PetscInt size;
  PetscFunctionBegin;
  PetscCall(ISGetLocalSize(self->rows, &size));
  PetscCall(MatCreateSeqDense(PETSC_COMM_SELF, size, sides, b, &right));
  PetscCall(MatCreateSeqDense(PETSC_COMM_SELF, size, sides, NULL, &left));
  PetscCall(MatMatSolve(self->factor, right, left));
  PetscCall(MatDenseGetArrayRead(left, &x));
  memcpy(b, x, (size_t)size * sides * sizeof *b);
  PetscCall(MatDenseRestoreArrayRead(left, &x));
  PetscCall(MatDestroy(&left));
  PetscCall(MatDestroy(&right));
  PetscFunctionReturn(0);
}
