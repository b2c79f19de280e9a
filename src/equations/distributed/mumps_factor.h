/* Options and answers of MUMPS, behind a solver of PETSc. */
#ifndef KEYWAY_MUMPS_FACTOR_H
#define KEYWAY_MUMPS_FACTOR_H
#include <petscksp.h>

/* Gives the preconditioner of a solver a factor of MUMPS, whose blocks may have low rank. */
PetscErrorCode choose_mumps(KSP solver, int is_symmetric, int is_compressed);

/* Factors the matrix of a solver. Where MUMPS lacks room, the next factor gets more. */
PetscErrorCode factor_by_mumps(KSP solver, int *lacks_room);

/* Solves for columns over the own rows, in place, all at once: a factor is read once for many. */
PetscErrorCode solve_columns(KSP solver, int rows, int sides, double *b);

/* Whether a symmetric factor has failed in its last columns, which are not positive definite. */
PetscErrorCode has_indefinite_end(KSP solver, int *answer);

/* Number of negative pivots of a symmetric factor. */
PetscErrorCode count_negative_pivots(KSP solver, PetscInt *negative);

/* Entries of the factor on this rank. */
PetscErrorCode count_factor_entries(KSP solver, double *entries);

/* Memory of the last factor: on one rank at most, on all ranks [MB]. */
PetscErrorCode read_factor_memory(KSP solver, int *memory);
#endif
