/* PETSc shifts no pivots of ICC in blocks. The diagonal of the whole matrix is shifted instead
 * (T. A. Manteuffel, Mathematics of Computation 34, 1980, 473-497): a large enough shift leaves a
 * positive definite factor of any positive definite matrix. */
#include "incomplete_factor.h"

/* Each shift is about the root of ten times as large as the one before. */
static const double shifts[] = {0, 1e-3, 3e-3, 1e-2, 3e-2, 0.1, 0.3, 1, 3, 10};
enum { num_shifts = sizeof shifts / sizeof *shifts };

/* Iterations of the trial. Broken factors of stretched bricks show within six. */
enum { trial_iterations = 20 };

/* Largest eigenvalue of the matrix over its factor without a doubt about the factor. Pivots that
 * have nearly become negative leave larger ones: 19 at s = 0.001, 9 at 0.003 and 2.8 at 0.01 in an
 * arch dam on stretched rock, with 77, 59 and 49 iterations of multigrid. */
static const double largest_of_good = 3;

/* No larger shift for the sake of speed alone: from here on iterations without multigrid grow. */
static const double shift_for_speed = 1e-2;

int raise_shift(struct incomplete_factor *self)
{
  for (int k = 1; k < num_shifts; k++) {
    if (shifts[k] <= self->shift) continue;
    self->shift = shifts[k];
    return 1;
  }
  return 0;
}

static PetscErrorCode give_operators(struct incomplete_factor *self, KSP solver, Mat blocks)
{
  Vec diagonal;
  PetscFunctionBegin;
  if (self->shift <= 0) {
    PetscCall(KSPSetOperators(solver, blocks, blocks));
    PetscFunctionReturn(0);
  }
  if (!self->shifted) PetscCall(MatDuplicate(blocks, MAT_COPY_VALUES, &self->shifted));
  else PetscCall(MatCopy(blocks, self->shifted, SAME_NONZERO_PATTERN));
  PetscCall(MatSetOption(self->shifted, MAT_SPD, PETSC_TRUE));
  PetscCall(MatCreateVecs(blocks, &diagonal, NULL));
  PetscCall(MatGetDiagonal(blocks, diagonal));
  PetscCall(VecScale(diagonal, 1 + self->shift));
  PetscCall(MatDiagonalSet(self->shifted, diagonal, INSERT_VALUES));
  PetscCall(VecDestroy(&diagonal));
  PetscCall(KSPSetOperators(solver, blocks, self->shifted));
  PetscFunctionReturn(0);
}

/* PETSc has no incomplete factor without rows: of a rank whose part of the structure is not there
 * in a stage, or that has no elements. */
static PetscErrorCode leave_out_empty(PC pc, Mat blocks)
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
  for (int k = 0; rows == 0 && k < num_own; k++) {
    PetscCall(KSPGetPC(own[k], &factor));
    PetscCall(PCSetType(factor, PCNONE));
  }
  PetscFunctionReturn(0);
}

/* Conjugate gradients meet a direction in which the preconditioner or the matrix is negative, if
 * there is one that matters. `largest` is the eigenvalue of the matrix over its factor, where no
 * such direction is found. */
static PetscErrorCode try_factor(KSP solver, Mat blocks, KSPConvergedReason *reason,
                                 PetscReal *largest)
{
  PC pc;
  KSP trial;
  Vec b, x;
  PetscReal least;
  PetscFunctionBegin;
  PetscCall(KSPGetPC(solver, &pc));
  PetscCall(MatCreateVecs(blocks, &x, &b));
  PetscCall(VecSetRandom(b, NULL));
  PetscCall(KSPCreate(PetscObjectComm((PetscObject)blocks), &trial));
  PetscCall(KSPSetType(trial, KSPCG));
  PetscCall(KSPSetNormType(trial, KSP_NORM_UNPRECONDITIONED));
  PetscCall(KSPSetPC(trial, pc));
  PetscCall(KSPSetComputeSingularValues(trial, PETSC_TRUE));
  PetscCall(KSPSetTolerances(trial, 1e-10, PETSC_DEFAULT, PETSC_DEFAULT, trial_iterations));
  PetscCall(KSPSolve(trial, b, x));
  PetscCall(KSPGetConvergedReason(trial, reason));
  if (*reason == KSP_DIVERGED_ITS) *reason = KSP_CONVERGED_ITS;
  *largest = 0;
  if (*reason > 0) PetscCall(KSPComputeExtremeSingularValues(trial, largest, &least));
  PetscCall(KSPDestroy(&trial));
  PetscCall(VecDestroy(&b));
  PetscCall(VecDestroy(&x));
  PetscFunctionReturn(0);
}

PetscErrorCode set_up_incomplete(struct incomplete_factor *self, KSP solver, Mat blocks,
                                 int *is_definite)
{
  PC pc;
  KSPConvergedReason reason;
  PetscReal largest;
  int is_poor;
  PetscFunctionBegin;
  PetscCall(KSPGetPC(solver, &pc));
  do {
    PetscCall(PCSetFailedReason(pc, PC_NOERROR));
    PetscCall(give_operators(self, solver, blocks));
    PetscCall(leave_out_empty(pc, blocks));
    PetscCall(try_factor(solver, blocks, &reason, &largest));
    is_poor = reason < 0 ? reason != KSP_DIVERGED_INDEFINITE_MAT
                         : largest > largest_of_good && self->shift < shift_for_speed;
  } while (is_poor && raise_shift(self));
  *is_definite = reason > 0;
  PetscCall(KSPSetUp(solver));
  PetscFunctionReturn(0);
}
