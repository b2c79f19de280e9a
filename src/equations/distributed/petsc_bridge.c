/* Behind petsc_equations.f90 with KEYWAY_PETSC: a matrix by rows, a solver, two vectors. */
#include <petscksp.h>
#include <stdio.h>
#include <stdlib.h>

#include "block_matrix.h"
#include "last_solutions.h"
#include "mumps_factor.h"

_Static_assert(sizeof(PetscInt) == sizeof(int), "PETSc must be built with 32-bit indices");
_Static_assert(sizeof(PetscScalar) == sizeof(double), "PETSc must be built with real scalars");

enum { by_cholesky = 1, by_multigrid = 2, by_blocks = 3, by_lu = 4, by_compressed = 5 };
enum { done = 0, singular = 1, slow = 2, failed = 3 };
enum { num_rigid = 6, rows_of_node = 3, most_iterations = 5000 };

/* Residual over the right-hand side, where the caller admits none. Results at 1e-6 of the largest
 * value need less; forces that nearly cancel need this. */
static const double tolerance = 1e-10;

/* Aggregates of one or two nodes have no six motions. Their empty rows on coarse levels get this
 * part of the largest diagonal entry, so that smoothers can divide. */
static const double of_empty_row = 1e-12;

struct equations {
  int method;
  int rows;
  Mat matrix;
  Mat blocks; /* the same in blocks of 3 x 3, upper triangle; by_blocks only */
  KSP solver;
  Vec b, x;
  struct last_solutions last;
};

static PetscErrorCode keep_quiet(MPI_Comm comm, int line, const char *function, const char *file,
                                 PetscErrorCode code, PetscErrorType type, const char *text,
                                 void *context)
{
  (void)comm, (void)line, (void)function, (void)file, (void)type, (void)text, (void)context;
  return code;
}

int keyway_has_petsc(void) { return 1; }

/* An option that the user has not set in PETSC_OPTIONS. */
static PetscErrorCode set_default(const char *name, const char *value)
{
  PetscBool is_set;
  PetscFunctionBegin;
  PetscCall(PetscOptionsHasName(NULL, NULL, name, &is_set));
  if (!is_set) PetscCall(PetscOptionsSetValue(NULL, name, value));
  PetscFunctionReturn(0);
}

void *keyway_petsc_start(void)
{
  PetscBool is_started;
  if (PetscInitialized(&is_started)) return NULL;
  if (!is_started) {
    /* Signals are the program's; PETSc's help on errors is not for users of the program. */
    if (PetscOptionsSetValue(NULL, "-no_signal_handler", "true")) return NULL;
    if (PetscInitializeNoArguments()) return NULL;
    if (PetscPushErrorHandler(keep_quiet, NULL)) return NULL;
    if (set_default("-keyway_sub_pc_type", "icc")) return NULL;
    if (set_default("-keyway_mg_levels_pc_type", "sor")) return NULL;
    if (set_default("-keyway_pc_gamg_threshold", "0.01")) return NULL;
  }
  return calloc(1, sizeof(struct equations));
}

void keyway_petsc_finish(void *handle)
{
  struct equations *self = handle;
  if (!self) return;
  KSPDestroy(&self->solver);
  MatDestroy(&self->matrix);
  MatDestroy(&self->blocks);
  forget_solutions(&self->last);
  VecDestroy(&self->b);
  VecDestroy(&self->x);
  free(self);
}

/* The motions of a rigid body, which multigrid must represent on every level. */
static PetscErrorCode give_rigid_motions(struct equations *self, const double *rigid)
{
  Vec motion[num_rigid];
  MatNullSpace space;
  PetscFunctionBegin;
  for (int k = 0; k < num_rigid; k++) {
    PetscScalar *own;
    PetscCall(VecDuplicate(self->b, &motion[k]));
    PetscCall(VecGetArray(motion[k], &own));
    for (int i = 0; i < self->rows; i++) own[i] = rigid[(size_t)k * self->rows + i];
    PetscCall(VecRestoreArray(motion[k], &own));
    for (int m = 0; m < k; m++) {
      PetscScalar product;
      PetscCall(VecDot(motion[k], motion[m], &product));
      PetscCall(VecAXPY(motion[k], -product, motion[m]));
    }
    PetscCall(VecNormalize(motion[k], NULL));
  }
  PetscCall(MatNullSpaceCreate(PETSC_COMM_WORLD, PETSC_FALSE, num_rigid, motion, &space));
  PetscCall(MatSetNearNullSpace(self->matrix, space));
  PetscCall(MatNullSpaceDestroy(&space));
  for (int k = 0; k < num_rigid; k++) PetscCall(VecDestroy(&motion[k]));
  PetscFunctionReturn(0);
}

static int is_direct(const struct equations *self)
{
  return self->method == by_cholesky || self->method == by_lu;
}

static int has_factor(const struct equations *self)
{
  return is_direct(self) || self->method == by_compressed;
}

static PetscErrorCode choose_method(struct equations *self)
{
  PC pc;
  PetscFunctionBegin;
  PetscCall(KSPCreate(PETSC_COMM_WORLD, &self->solver));
  PetscCall(KSPSetOptionsPrefix(self->solver, "keyway_"));
  PetscCall(KSPSetOperators(self->solver, self->matrix, self->matrix));
  PetscCall(KSPGetPC(self->solver, &pc));
  PetscCall(KSPSetType(self->solver, is_direct(self) ? KSPPREONLY : KSPCG));
  if (!is_direct(self)) {
    PetscCall(KSPSetNormType(self->solver, KSP_NORM_UNPRECONDITIONED));
    PetscCall(KSPSetInitialGuessNonzero(self->solver, PETSC_TRUE));
  }
  if (has_factor(self)) {
    PetscCall(choose_mumps(self->solver, self->method != by_lu, self->method == by_compressed));
  } else {
    PetscCall(PCSetType(pc, self->method == by_multigrid ? PCGAMG : PCBJACOBI));
  }
  PetscCall(KSPSetFromOptions(self->solver));
  PetscFunctionReturn(0);
}

static PetscErrorCode plan(struct equations *self, const double *rigid, size_t entries, int *row,
                           int *column)
{
  PetscFunctionBegin;
  PetscCall(MatCreate(PETSC_COMM_WORLD, &self->matrix));
  PetscCall(MatSetSizes(self->matrix, self->rows, self->rows, PETSC_DETERMINE, PETSC_DETERMINE));
  PetscCall(MatSetType(self->matrix, MATAIJ));
  PetscCall(MatSetBlockSize(self->matrix, rows_of_node));
  PetscCall(MatSetPreallocationCOO(self->matrix, (PetscCount)entries, row, column));
  if (self->method != by_lu) PetscCall(MatSetOption(self->matrix, MAT_SPD, PETSC_TRUE));
  PetscCall(MatCreateVecs(self->matrix, &self->x, &self->b));
  if (self->method == by_multigrid) PetscCall(give_rigid_motions(self, rigid));
  PetscCall(choose_method(self));
  PetscFunctionReturn(0);
}

int keyway_petsc_plan(void *handle, int method, int rows, const double *rigid, size_t entries,
                      int *row, int *column)
{
  struct equations *self = handle;
  self->method = method;
  self->rows = rows;
  return plan(self, rigid, entries, row, column) ? failed : done;
}

/* Whether the factor solves for forces that no symmetry cancels: a body that is free to move
 * answers them with displacements of 1/round-off. */
static PetscErrorCode check_factor(struct equations *self, int *status)
{
  Vec scale, residual;
  PetscScalar *own, work, stiff;
  PetscInt first;
  KSPConvergedReason reason;
  PetscFunctionBegin;
  PetscCall(VecDuplicate(self->b, &scale));
  PetscCall(VecDuplicate(self->b, &residual));
  PetscCall(MatGetDiagonal(self->matrix, scale));
  PetscCall(VecGetOwnershipRange(self->b, &first, NULL));
  PetscCall(VecGetArray(self->b, &own));
  for (int i = 0; i < self->rows; i++) {
    const unsigned mixed = (unsigned)(first + i + 1) * 2654435761u;
    own[i] = (double)(mixed >> 8) / (1 << 24) - 0.5;
  }
  PetscCall(VecRestoreArray(self->b, &own));
  PetscCall(VecPointwiseMult(self->b, self->b, scale));
  PetscCall(VecSet(self->x, 0));
  PetscCall(KSPSetTolerances(self->solver, tolerance, PETSC_DEFAULT, PETSC_DEFAULT,
                             most_iterations));
  PetscCall(KSPSolve(self->solver, self->b, self->x));
  PetscCall(KSPGetConvergedReason(self->solver, &reason));
  /* x.b against b.b/diagonal: the softest direction over the stiffness of one node */
  PetscCall(VecDot(self->x, self->b, &work));
  PetscCall(VecPointwiseDivide(residual, self->b, scale));
  PetscCall(VecDot(residual, self->b, &stiff));
  *status = reason > 0 && PetscAbsReal(work) < 1e13 * stiff ? done : singular;
  if (self->method != by_lu) {
    PetscInt negative;
    PetscCall(count_negative_pivots(self->solver, &negative));
    if (negative > 0 || work <= 0) *status = singular;
  }
  PetscCall(VecDestroy(&scale));
  PetscCall(VecDestroy(&residual));
  PetscFunctionReturn(0);
}

/* The matrix that the iteration multiplies with: in blocks, which read half as many indices. */
static PetscErrorCode give_matrix(struct equations *self)
{
  PetscFunctionBegin;
  if (self->method == by_blocks) {
    PetscCall(copy_to_blocks(self->matrix, &self->blocks));
    PetscCall(KSPSetOperators(self->solver, self->blocks, self->blocks));
  } else {
    PetscCall(KSPSetOperators(self->solver, self->matrix, self->matrix));
  }
  PetscFunctionReturn(0);
}

static PetscErrorCode fill_empty_rows(struct equations *self)
{
  char text[32];
  PetscReal largest;
  Vec diagonal;
  PetscFunctionBegin;
  PetscCall(VecDuplicate(self->b, &diagonal));
  PetscCall(MatGetDiagonal(self->matrix, diagonal));
  PetscCall(VecMax(diagonal, NULL, &largest));
  PetscCall(VecDestroy(&diagonal));
  snprintf(text, sizeof text, "%.6e", of_empty_row * largest);
  PetscCall(PetscOptionsSetValue(NULL, "-keyway_mg_levels_pc_sor_diagonal_shift", text));
  PetscFunctionReturn(0);
}

static PetscErrorCode factor(struct equations *self, const double *values, int *status)
{
  PC pc;
  PCFailedReason reason;
  int is_repeated = 0;
  PetscFunctionBegin;
  PetscCall(forget_solutions(&self->last));
  do {
    PetscCall(MatSetValuesCOO(self->matrix, values, INSERT_VALUES));
    if (self->method == by_multigrid) PetscCall(fill_empty_rows(self));
    PetscCall(give_matrix(self));
    if (is_repeated) PetscCall(choose_mumps(self->solver, self->method != by_lu,
                                            self->method == by_compressed));
    if (has_factor(self)) PetscCall(factor_by_mumps(self->solver, &is_repeated));
    else PetscCall(KSPSetUp(self->solver));
  } while (is_repeated);
  PetscCall(KSPGetPC(self->solver, &pc));
  PetscCall(PCGetFailedReason(pc, &reason));
  *status = reason ? singular : done;
  if (reason == PC_FACTOR_OUTMEMORY || reason == PC_FACTOR_OTHER) *status = failed;
  if (*status == done && has_factor(self)) PetscCall(check_factor(self, status));
  PetscFunctionReturn(0);
}

int keyway_petsc_factor(void *handle, size_t entries, const double *values)
{
  int status = failed;
  (void)entries;
  return factor(handle, values, &status) ? failed : status;
}

static PetscErrorCode solve(struct equations *self, double admissible, int is_kept, double *b,
                            int *iterations, int *status)
{
  PetscScalar *own, with[most_kept];
  KSPConvergedReason reason;
  PetscInt count;
  PetscFunctionBegin;
  PetscCall(VecGetArray(self->b, &own));
  for (int i = 0; i < self->rows; i++) own[i] = b[i];
  PetscCall(VecRestoreArray(self->b, &own));
  if (!is_direct(self)) {
    PetscCall(KSPSetTolerances(self->solver, tolerance, admissible, PETSC_DEFAULT,
                               most_iterations));
    PetscCall(combine_solutions(&self->last, self->b, with, self->x));
  }
  PetscCall(KSPSolve(self->solver, self->b, self->x));
  PetscCall(KSPGetConvergedReason(self->solver, &reason));
  PetscCall(KSPGetIterationNumber(self->solver, &count));
  if (is_kept && !is_direct(self) && reason > 0)
    PetscCall(keep_solution(&self->last, self->b, with, self->x));
  PetscCall(VecGetArray(self->x, &own));
  for (int i = 0; i < self->rows; i++) b[i] = own[i];
  PetscCall(VecRestoreArray(self->x, &own));
  *iterations = count;
  *status = reason > 0 ? done : reason == KSP_DIVERGED_ITS ? slow : singular;
  PetscFunctionReturn(0);
}

/* Entries of the factor or, without one, of the matrix, on this rank. */
static PetscErrorCode count_entries(struct equations *self, double *entries)
{
  MatInfo info;
  PetscFunctionBegin;
  if (has_factor(self)) {
    PetscCall(count_factor_entries(self->solver, entries));
  } else {
    PetscCall(MatGetInfo(self->matrix, MAT_LOCAL, &info));
    *entries = info.nz_used;
  }
  PetscFunctionReturn(0);
}

void keyway_petsc_memory(void *handle, int *memory)
{
  struct equations *self = handle;
  memory[0] = memory[1] = 0;
  if (has_factor(self) && read_factor_memory(self->solver, memory)) memory[0] = memory[1] = 0;
}

double keyway_petsc_entries(void *handle)
{
  double entries = 0;
  return count_entries(handle, &entries) ? 0 : entries;
}

/* All columns at once: a factor is read once for many of them. */
static PetscErrorCode solve_columns(struct equations *self, int sides, double *b)
{
  Mat right, left;
  const PetscScalar *own;
  PetscInt stride;
  PetscFunctionBegin;
  PetscCall(MatCreateDense(PETSC_COMM_WORLD, self->rows, PETSC_DECIDE, PETSC_DETERMINE, sides, b,
                           &right));
  PetscCall(MatDuplicate(right, MAT_DO_NOT_COPY_VALUES, &left));
  PetscCall(KSPMatSolve(self->solver, right, left));
  PetscCall(MatDenseGetLDA(left, &stride));
  PetscCall(MatDenseGetArrayRead(left, &own));
  for (int k = 0; k < sides; k++)
    for (int i = 0; i < self->rows; i++)
      b[(size_t)k * self->rows + i] = own[(size_t)k * stride + i];
  PetscCall(MatDenseRestoreArrayRead(left, &own));
  PetscCall(MatDestroy(&left));
  PetscCall(MatDestroy(&right));
  PetscFunctionReturn(0);
}

int keyway_petsc_solve(void *handle, int rows, int sides, double admissible, double *b,
                       int *iterations)
{
  struct equations *self = handle;
  int status = done;
  for (int k = 0; k < sides; k++) iterations[k] = 0;
  if (sides > 1 && is_direct(self)) return solve_columns(self, sides, b) ? failed : done;
  for (int k = 0; k < sides && status == done; k++) {
    int count = 0;
    if (solve(self, admissible, sides == 1, b + (size_t)k * rows, &count, &status)) return failed;
    iterations[k] = count;
  }
  return status;
}
