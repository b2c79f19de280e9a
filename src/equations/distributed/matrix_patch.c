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
static PetscErrorCode factor_part(Mat part, Mat *both, int *has_failed)
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
  *has_failed = error != MAT_FACTOR_NOERROR;
  PetscFunctionReturn(0);
}

PetscErrorCode take_patch(Mat matrix, int layers, int count, const int *seed,
                          struct matrix_patch *self, int *has_failed)
{
  const PetscInt num_patches = count > 0;
  IS near = NULL;
  Mat *part;
  PetscFunctionBegin;
  *has_failed = 0;
  if (num_patches) {
    PetscCall(ISCreateGeneral(PETSC_COMM_SELF, count, seed, PETSC_COPY_VALUES, &near));
    PetscCall(ISSortRemoveDups(near));
  }
  PetscCall(MatIncreaseOverlap(matrix, num_patches, &near, layers));
  if (num_patches) PetscCall(ISSort(near));
  PetscCall(MatCreateSubMatrices(matrix, num_patches, &near, &near, MAT_INITIAL_MATRIX, &part));
  if (num_patches) {
    PetscCall(forget_patch(self));
    self->rows = near;
    PetscCall(factor_part(part[0], &self->factor, has_failed));
  }
  PetscCall(MatDestroySubMatrices(num_patches, &part));
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
