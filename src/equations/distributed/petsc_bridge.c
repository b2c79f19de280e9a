/* Behind petsc_equations.f90 with KEYWAY_PETSC: a matrix by rows, a solver, two vectors. */
#include <petscksp.h>
#include <stdlib.h>

#include "block_matrix.h"
#include "iteration/last_solutions.h"
#include "iteration/two_levels.h"
#include "matrix_patch.h"
#include "mumps_factor.h"
#include "petsc_start.h"

_Static_assert(sizeof(PetscInt) == sizeof(int), "PETSc must be built with 32-bit indices");
_Static_assert(sizeof(PetscScalar) == sizeof(double), "PETSc must be built with real scalars");

enum { by_cholesky = 1, by_iteration = 2, by_lu = 3, by_compressed = 4 };
enum { done = 0, singular = 1, slow = 2, failed = 3 };
enum { rows_of_node = 3, most_iterations = 5000 };

/* Residual over the right-hand side, where the caller admits none. Results at 1e-6 of the largest
 * value need less; forces that nearly cancel need this. */
static const double tolerance = 1e-10;

/* The same where the caller admits a residual. The right-hand side, of stiff joints or of inertia,
 * can be many times the forces that the residual is compared with. */
static const double least_residual = 1e-14;

/* A residual may be many times that of the prediction, which is small, before it falls. */
static const double any_growth = 1e50;

struct equations {
  int method;
  int rows;
  Mat matrix; /* by rows with by_lu, else the upper triangle in blocks of 3 x 3 */
  Mat both;   /* both triangles by rows, for patches; NULL for none */
  struct block_list list; /* of what this rank adds to blocks */
  struct two_levels levels; /* by_iteration */
  KSP solver;
  Vec b, x;
  Vec rest, correction; /* of the prediction of an iteration: residual, and what x lacks */
  struct last_solutions last;
  struct matrix_patch patch;
};

int keyway_has_petsc(void) { return 1; }

void *keyway_petsc_start(void)
{
  return start_petsc() ? NULL : calloc(1, sizeof(struct equations));
}

void keyway_petsc_finish(void *handle)
{
  struct equations *self = handle;
  if (!self) return;
  KSPDestroy(&self->solver);
  MatDestroy(&self->matrix);
  MatDestroy(&self->both);
  forget_list(&self->list);
  forget_two_levels(&self->levels);
  forget_solutions(&self->last);
  forget_patch(&self->patch);
  VecDestroy(&self->b);
  VecDestroy(&self->x);
  VecDestroy(&self->rest);
  VecDestroy(&self->correction);
  free(self);
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
  PetscFunctionBegin;
  PetscCall(KSPCreate(PETSC_COMM_WORLD, &self->solver));
  PetscCall(KSPSetOptionsPrefix(self->solver, "keyway_"));
  PetscCall(KSPSetOperators(self->solver, self->matrix, self->matrix));
  PetscCall(KSPSetType(self->solver, is_direct(self) ? KSPPREONLY : KSPCG));
  if (!is_direct(self)) {
    PetscCall(KSPSetNormType(self->solver, KSP_NORM_UNPRECONDITIONED));
    PetscCall(KSPSetInitialGuessNonzero(self->solver, PETSC_TRUE));
  }
  if (has_factor(self))
    PetscCall(choose_mumps(self->solver, self->method != by_lu, self->method == by_compressed));
  PetscCall(KSPSetFromOptions(self->solver));
  PetscFunctionReturn(0);
}

static PetscErrorCode plan_rows(struct equations *self, size_t entries, int *row, int *column)
{
  PetscFunctionBegin;
  PetscCall(MatCreate(PETSC_COMM_WORLD, &self->matrix));
  PetscCall(MatSetSizes(self->matrix, self->rows, self->rows, PETSC_DETERMINE, PETSC_DETERMINE));
  PetscCall(MatSetType(self->matrix, MATAIJ));
  PetscCall(MatSetBlockSize(self->matrix, rows_of_node));
  PetscCall(MatSetPreallocationCOO(self->matrix, (PetscCount)entries, row, column));
  PetscFunctionReturn(0);
}

static PetscErrorCode plan(struct equations *self, const double *rigid, size_t entries, int *row,
                           int *column)
{
  PetscFunctionBegin;
  if (self->method == by_lu) {
    PetscCall(plan_rows(self, entries, row, column));
  } else {
    PetscCall(make_list(self->rows, entries, row, column, &self->list));
    PetscCall(plan_blocks(self->rows, &self->list, &self->matrix));
  }
  PetscCall(MatCreateVecs(self->matrix, &self->x, &self->b));
  PetscCall(VecDuplicate(self->b, &self->rest));
  PetscCall(VecDuplicate(self->x, &self->correction));
  if (self->method == by_iteration)
    PetscCall(keep_rigid_motions(&self->levels.coarse, self->rows, rigid));
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
  PetscCall(KSPSetTolerances(self->solver, tolerance, 0, any_growth, most_iterations));
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

/* A factor of MUMPS, again where it has lacked room. */
static PetscErrorCode set_up_factor(struct equations *self, int *status)
{
  PC pc;
  PCFailedReason reason;
  int is_repeated = 0, is_indefinite;
  PetscFunctionBegin;
  do {
    PetscCall(KSPSetOperators(self->solver, self->matrix, self->matrix));
    if (is_repeated) PetscCall(choose_mumps(self->solver, self->method != by_lu,
                                            self->method == by_compressed));
    PetscCall(factor_by_mumps(self->solver, &is_repeated));
  } while (is_repeated);
  PetscCall(KSPGetPC(self->solver, &pc));
  PetscCall(PCGetFailedReason(pc, &reason));
  *status = reason ? singular : done;
  if (reason == PC_FACTOR_OUTMEMORY) *status = failed;
  if (reason == PC_FACTOR_OTHER) {
    PetscCall(has_indefinite_end(self->solver, &is_indefinite));
    if (!is_indefinite) *status = failed;
  }
  if (*status == done) PetscCall(check_factor(self, status));
  PetscFunctionReturn(0);
}

static PetscErrorCode sum(struct equations *self, const double *values)
{
  PetscFunctionBegin;
  PetscCall(forget_solutions(&self->last));
  PetscCall(MatDestroy(&self->both));
  if (self->method == by_lu) PetscCall(MatSetValuesCOO(self->matrix, values, INSERT_VALUES));
  else PetscCall(sum_blocks(&self->list, values, self->matrix));
  PetscFunctionReturn(0);
}

/* The caller frees the values before the factor takes memory. */
int keyway_petsc_sum(void *handle, const double *values)
{
  return sum(handle, values) ? failed : done;
}

static PetscErrorCode factor(struct equations *self, int *status)
{
  int is_definite;
  PetscFunctionBegin;
  if (has_factor(self)) {
    PetscCall(set_up_factor(self, status));
  } else {
    PetscCall(set_up_two_levels(&self->levels, self->solver, self->matrix, &is_definite));
    *status = is_definite ? done : singular;
  }
  PetscFunctionReturn(0);
}

int keyway_petsc_factor(void *handle)
{
  int status = failed;
  return factor(handle, &status) ? failed : status;
}

/* Predicts x, and the part of its correction in the coarse space. The residual of x may be round-off
 * of the forces A x: in a correction, all of its digits count. */
static PetscErrorCode predict(struct equations *self, PetscScalar *with)
{
  PetscFunctionBegin;
  PetscCall(combine_solutions(&self->last, self->b, with, self->x));
  PetscCall(MatResidual(self->matrix, self->b, self->x, self->rest));
  PetscCall(VecSet(self->correction, 0));
  if (!has_factor(self))
    PetscCall(add_coarse_solution(&self->levels.coarse, self->rest, self->correction));
  PetscFunctionReturn(0);
}

/* Conjugate gradients, again with a larger shift where a direction shows in which the incomplete
 * factor is negative. */
static PetscErrorCode iterate(struct equations *self, double admissible, PetscScalar *with,
                              KSPConvergedReason *reason, int *iterations)
{
  int is_repeated;
  PetscReal force;
  *iterations = 0;
  PetscFunctionBegin;
  PetscCall(VecNorm(self->b, NORM_2, &force));
  force *= admissible > 0 ? least_residual : tolerance;
  PetscCall(KSPSetTolerances(self->solver, 0, PetscMax(force, admissible), any_growth,
                             most_iterations));
  do {
    PetscInt count;
    PetscCall(predict(self, with));
    PetscCall(KSPSolve(self->solver, self->rest, self->correction));
    PetscCall(KSPGetConvergedReason(self->solver, reason));
    PetscCall(KSPGetIterationNumber(self->solver, &count));
    *iterations += count;
    is_repeated = !has_factor(self) && *reason == KSP_DIVERGED_INDEFINITE_PC
                  && raise_shift(&self->levels.fine);
    if (is_repeated)
      PetscCall(set_up_incomplete(&self->levels.fine, self->matrix, &is_repeated));
  } while (is_repeated);
  PetscCall(VecAXPY(self->x, 1, self->correction));
  PetscFunctionReturn(0);
}

static PetscErrorCode solve(struct equations *self, double admissible, int is_kept, double *b,
                            int *iterations, int *status)
{
  PetscScalar *own, with[most_kept];
  KSPConvergedReason reason;
  PetscFunctionBegin;
  PetscCall(VecGetArray(self->b, &own));
  for (int i = 0; i < self->rows; i++) own[i] = b[i];
  PetscCall(VecRestoreArray(self->b, &own));
  if (is_direct(self)) {
    PetscCall(KSPSolve(self->solver, self->b, self->x));
    PetscCall(KSPGetConvergedReason(self->solver, &reason));
  } else {
    PetscCall(iterate(self, admissible, with, &reason, iterations));
    if (is_kept && reason > 0)
      PetscCall(keep_solution(&self->last, self->b, with, self->x));
  }
  PetscCall(VecGetArray(self->x, &own));
  for (int i = 0; i < self->rows; i++) b[i] = own[i];
  PetscCall(VecRestoreArray(self->x, &own));
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

double keyway_petsc_shift(void *handle)
{
  const struct equations *self = handle;
  return unusual_shift(&self->levels.fine);
}

double keyway_petsc_entries(void *handle)
{
  double entries = 0;
  return count_entries(handle, &entries) ? 0 : entries;
}

int keyway_petsc_solve(void *handle, int rows, int sides, double admissible, double *b,
                       int *iterations)
{
  struct equations *self = handle;
  int status = done;
  for (int k = 0; k < sides; k++) iterations[k] = 0;
  if (sides > 1 && is_direct(self))
    return solve_columns(self->solver, self->rows, sides, b) ? failed : done;
  for (int k = 0; k < sides && status == done; k++) {
    int count = 0;
    if (solve(self, admissible, sides == 1, b + (size_t)k * rows, &count, &status)) return failed;
    iterations[k] = count;
  }
  return status;
}

int keyway_petsc_patch(void *handle, int layers, int most, int count, const int *seed, int *rows)
{
  struct equations *self = handle;
  enum patch_outcome outcome;
  *rows = 0;
  if (!self->both && copy_to_rows(self->matrix, &self->both)) return failed;
  if (take_patch(self->both, layers, most, count, seed, &self->patch, &outcome)) return failed;
  if (outcome != patch_too_large && count_patch_rows(&self->patch, rows)) return failed;
  return outcome == patch_has_no_factor ? singular : done;
}

void keyway_petsc_drop_patch(void *handle)
{
  struct equations *self = handle;
  if (!self) return;
  forget_patch(&self->patch);
  MatDestroy(&self->both);
}

int keyway_petsc_patch_rows(void *handle, int rows, int *row)
{
  struct equations *self = handle;
  return rows > 0 && copy_patch_rows(&self->patch, row) ? failed : done;
}

int keyway_petsc_solve_patch(void *handle, int rows, int sides, double *b)
{
  struct equations *self = handle;
  return rows > 0 && solve_patch(&self->patch, sides, b) ? failed : done;
}
