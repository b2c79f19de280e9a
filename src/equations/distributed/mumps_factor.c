#include "mumps_factor.h"

#include <stdio.h>

/* Error of the blocks of low rank, relative to the scaled matrix. */
static const double compression = 1e-5;

/* Room that MUMPS gets beyond its estimate [%], and where doubling it ends. */
enum { first_room = 60, most_room = 480 };

/* ICNTL of MUMPS, and the values of INFOG(1) that ask for more room. */
enum { icntl_room = 14, icntl_low_rank = 35, in_factor_and_solves = 2, cntl_low_rank = 7 };
enum { few_integers = -8, few_reals = -9 };

/* INFOG(1) of a symmetric matrix that is not positive definite in the last columns of its factor,
 * which ScaLAPACK computes on several ranks. */
enum { last_columns_indefinite = -40 };

/* The factor, before it is computed too. */
static PetscErrorCode find_factor(KSP solver, Mat *both)
{
  PC pc;
  PetscFunctionBegin;
  PetscCall(KSPGetPC(solver, &pc));
  PetscCall(PCFactorSetUpMatSolverType(pc));
  PetscCall(PCFactorGetMatrix(pc, both));
  PetscFunctionReturn(0);
}

PetscErrorCode choose_mumps(KSP solver, int is_symmetric, int is_compressed)
{
  PC pc;
  Mat both, matrix;
  const char *prefix;
  PetscFunctionBegin;
  /* Before there is a factor: else MUMPS would not find the options of the user. */
  PetscCall(KSPGetOptionsPrefix(solver, &prefix));
  PetscCall(KSPGetOperators(solver, NULL, &matrix));
  PetscCall(MatSetOptionsPrefixFactor(matrix, prefix));
  PetscCall(KSPGetPC(solver, &pc));
  PetscCall(PCSetType(pc, is_symmetric ? PCCHOLESKY : PCLU));
  PetscCall(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
  PetscCall(find_factor(solver, &both));
  PetscCall(MatMumpsSetIcntl(both, icntl_room, first_room));
  if (is_compressed) {
    PetscCall(MatMumpsSetIcntl(both, icntl_low_rank, in_factor_and_solves));
    PetscCall(MatMumpsSetCntl(both, cntl_low_rank, compression));
  }
  PetscFunctionReturn(0);
}

PetscErrorCode factor_by_mumps(KSP solver, int *lacks_room)
{
  PC pc;
  Mat both;
  PetscInt cause, room;
  char text[16];
  PetscFunctionBegin;
  PetscCall(KSPSetUp(solver));
  PetscCall(find_factor(solver, &both));
  PetscCall(MatMumpsGetInfog(both, 1, &cause));
  PetscCall(MatMumpsGetIcntl(both, icntl_room, &room));
  *lacks_room = (cause == few_integers || cause == few_reals) && room < most_room;
  if (!*lacks_room) PetscFunctionReturn(0);
  /* PETSc factors no matrix again after a failure: the new factor reads its room as an option. */
  snprintf(text, sizeof text, "%d", 2 * (int)PetscMax(room, first_room));
  PetscCall(PetscOptionsSetValue(NULL, "-keyway_mat_mumps_icntl_14", text));
  PetscCall(KSPGetPC(solver, &pc));
  PetscCall(PCReset(pc));
  PetscFunctionReturn(0);
}

PetscErrorCode has_indefinite_end(KSP solver, int *answer)
{
  Mat both;
  PetscInt cause;
  PetscFunctionBegin;
  PetscCall(find_factor(solver, &both));
  PetscCall(MatMumpsGetInfog(both, 1, &cause));
  *answer = cause == last_columns_indefinite;
  PetscFunctionReturn(0);
}

PetscErrorCode count_negative_pivots(KSP solver, PetscInt *negative)
{
  Mat both;
  PetscFunctionBegin;
  PetscCall(find_factor(solver, &both));
  PetscCall(MatMumpsGetInfog(both, 12, negative));
  PetscFunctionReturn(0);
}

PetscErrorCode count_factor_entries(KSP solver, double *entries)
{
  Mat both;
  PetscInt count;
  PetscFunctionBegin;
  PetscCall(find_factor(solver, &both));
  PetscCall(MatMumpsGetInfo(both, 9, &count));
  *entries = count < 0 ? -1e6 * count : count; /* MUMPS counts many entries in millions */
  PetscFunctionReturn(0);
}

PetscErrorCode read_factor_memory(KSP solver, int *memory)
{
  Mat both;
  PetscInt most, sum;
  PetscFunctionBegin;
  PetscCall(find_factor(solver, &both));
  PetscCall(MatMumpsGetInfog(both, 21, &most));
  PetscCall(MatMumpsGetInfog(both, 22, &sum));
  memory[0] = most;
  memory[1] = sum;
  PetscFunctionReturn(0);
}

PetscErrorCode solve_columns(KSP solver, int rows, int sides, double *b)
{
  Mat right, left;
  const PetscScalar *own;
  PetscInt stride;
  PetscFunctionBegin;
  PetscCall(MatCreateDense(PETSC_COMM_WORLD, rows, PETSC_DECIDE, PETSC_DETERMINE, sides, b, &right));
  PetscCall(MatDuplicate(right, MAT_DO_NOT_COPY_VALUES, &left));
  PetscCall(KSPMatSolve(solver, right, left));
  PetscCall(MatDenseGetLDA(left, &stride));
  PetscCall(MatDenseGetArrayRead(left, &own));
  for (int k = 0; k < sides; k++)
    for (int i = 0; i < rows; i++)
      b[(size_t)k * rows + i] = own[(size_t)k * stride + i];
  PetscCall(MatDenseRestoreArrayRead(left, &own));
  PetscCall(MatDestroy(&left));
  PetscCall(MatDestroy(&right));
  PetscFunctionReturn(0);
}
