/* Incomplete Cholesky factors of a matrix in blocks of 3 x 3, one for the rows of each rank. */
#ifndef KEYWAY_INCOMPLETE_FACTOR_H
#define KEYWAY_INCOMPLETE_FACTOR_H
#include <petscksp.h>

struct incomplete_factor {
  double shift; /* the factor is that of the matrix with 1 + shift times its diagonal */
  Mat shifted;  /* that matrix, where there is a shift */
};

/* Gives a solver the matrix, and factors with the least shift that leaves a positive definite
 * preconditioner, and up to 0.01 one that is not far from the matrix; a shift that was needed
 * before is kept. No shift may suffice, and the matrix may not be positive definite. */
PetscErrorCode set_up_incomplete(struct incomplete_factor *self, KSP solver, Mat blocks,
                                 int *is_definite);

/* The next larger shift, for a factor that has failed in a solve; 0: there is none. */
int raise_shift(struct incomplete_factor *self);
#endif
