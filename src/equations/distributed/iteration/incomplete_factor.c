/* PETSc shifts no pivots of ICC in blocks. The diagonal of the whole matrix is shifted instead
 * (T. A. Manteuffel, Mathematics of Computation 34, 1980, 473-497): a large enough shift leaves a
 * positive definite factor of any positive definite matrix. */
#include "incomplete_factor.h"

/* The first one is that of most matrices: with 0 to 0.003 iterations on even bricks are 0.9 to 1.3
 * times as many, and on stretched bricks several times as many, where pivots have nearly become
 * negative. Each shift is about the root of ten times as large as the one before. */
static const double shifts[] = {1e-2, 3e-2, 0.1, 0.3, 1, 3, 10};
enum { num_shifts = sizeof shifts / sizeof *shifts };

/* Iterations of the trial. Broken factors of stretched bricks show within six. */
enum { trial_iterations = 20 };

double unusual_shift(const struct incomplete_factor *self)
{
  return self->shift > shifts[0] ? self->shift : 0;
}

int raise_shift(struct incomplete_factor *self)
{
  for (int k = 0; k < num_shifts; k++) {
    if (shifts[k] <= self->shift) continue;
    self->shift = shifts[k];
    return 1;
  }
  return 0;
}

/* Makes each rank factor its rows anew. PETSc has no incomplete factor without rows: of a rank whose
 * part of the structure is not there in a stage, or that has no elements. */
static PetscErrorCode open_parts(PC pc, Mat blocks)
{
  PC factor;
  KSP *own;
  PetscBool is_divided;
  PetscInt rows, num_own;
  PetscFunctionBegin;
  PetscCall(PetscObjectTypeCompare((PetscObject)pc, PCBJACOBI, &is_divided));
  if (!is_divided) PetscFunctionReturn(0);
  PetscCall(PCSetUp(pc));
  PetscCall(MatGetLocalSize(blocks, &rows, NULL));
  PetscCall(PCBJacobiGetSubKSP(pc, &num_own, NULL, &own));
  for (int k = 0; k < num_own; k++) {
    PetscCall(KSPSetReusePreconditioner(own[k], PETSC_FALSE));
    PetscCall(KSPGetPC(own[k], &factor));
    if (rows == 0) PetscCall(PCSetType(factor, PCNONE));
  }
  PetscFunctionReturn(0);
}

/* Conjugate gradients meet a direction in which the preconditioner or the matrix is negative, if
 * there is one that matters. */
static PetscErrorCode try_factor(KSP solver, Mat blocks, KSPConvergedReason *reason)
{
  PC pc;
  KSP trial;
  Vec b, x;
  PetscFunctionBegin;
  PetscCall(KSPGetPC(solver, &pc));
  PetscCall(MatCreateVecs(blocks, &x, &b));
  PetscCall(VecSetRandom(b, NULL));
  PetscCall(KSPCreate(PetscObjectComm((PetscObject)blocks), &trial));
  PetscCall(KSPSetType(trial, KSPCG));
  PetscCall(KSPSetNormType(trial, KSP_NORM_UNPRECONDITIONED));
  PetscCall(KSPSetPC(trial, pc));
  PetscCall(KSPSetTolerances(trial, 1e-10, PETSC_DEFAULT, PETSC_DEFAULT, trial_iterations));
  PetscCall(KSPSolve(trial, b, x));
  PetscCall(KSPGetConvergedReason(trial, reason));
  if (*reason == KSP_DIVERGED_ITS) *reason = KSP_CONVERGED_ITS;
  PetscCall(KSPDestroy(&trial));
  PetscCall(VecDestroy(&b));
  PetscCall(VecDestroy(&x));
  PetscFunctionReturn(0);
}

static PetscErrorCode make_solver(struct incomplete_factor *self, Mat blocks)
{
  PC pc;
  PetscFunctionBegin;
  PetscCall(KSPCreate(PetscObjectComm((PetscObject)blocks), &self->solver));
  PetscCall(KSPSetOptionsPrefix(self->solver, "keyway_"));
  PetscCall(KSPGetPC(self->solver, &pc));
  PetscCall(PCSetType(pc, PCBJACOBI));
  PetscCall(PCSetFromOptions(pc));
  PetscFunctionReturn(0);
}

/* Factors the matrix with the shift on its diagonal. PETSc would factor again when the diagonal is
 * back. */
static PetscErrorCode factor_shifted(struct incomplete_factor *self, Mat blocks)
{
  PC pc;
  Vec diagonal, shifted;
  PetscFunctionBegin;
  PetscCall(MatCreateVecs(blocks, &diagonal, NULL));
  PetscCall(MatGetDiagonal(blocks, diagonal));
  PetscCall(VecDuplicate(diagonal, &shifted));
  PetscCall(VecCopy(diagonal, shifted));
  PetscCall(VecScale(shifted, 1 + self->shift));
  PetscCall(MatDiagonalSet(blocks, shifted, INSERT_VALUES));
  PetscCall(KSPGetPC(self->solver, &pc));
  PetscCall(PCSetFailedReason(pc, PC_NOERROR));
  PetscCall(PCSetReusePreconditioner(pc, PETSC_FALSE));
  PetscCall(KSPSetOperators(self->solver, blocks, blocks));
  PetscCall(open_parts(pc, blocks));
  PetscCall(PCSetUp(pc));
  PetscCall(PCSetUpOnBlocks(pc));
  PetscCall(PCSetReusePreconditioner(pc, PETSC_TRUE));
  PetscCall(MatDiagonalSet(blocks, diagonal, INSERT_VALUES));
  PetscCall(VecDestroy(&diagonal));
  PetscCall(VecDestroy(&shifted));
  PetscFunctionReturn(0);
}

PetscErrorCode set_up_incomplete(struct incomplete_factor *self, Mat blocks, int *is_definite)
{
  KSPConvergedReason reason;
  PetscFunctionBegin;
  if (!self->solver) PetscCall(make_solver(self, blocks));
  if (self->shift <= 0) raise_shift(self);
  do {
    PetscCall(factor_shifted(self, blocks));
    PetscCall(try_factor(self->solver, blocks, &reason));
  } while (reason < 0 && reason != KSP_DIVERGED_INDEFINITE_MAT && raise_shift(self));
  *is_definite = reason > 0;
  PetscFunctionReturn(0);
}

PetscErrorCode forget_incomplete(struct incomplete_factor *self)
{
  PetscFunctionBegin;
  PetscCall(KSPDestroy(&self->solver));
  PetscFunctionReturn(0);
}
