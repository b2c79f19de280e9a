/* Incomplete Cholesky factors of a matrix in blocks of 3 x 3, one for the rows of each rank. */
#ifndef KEYWAY_INCOMPLETE_FACTOR_H
#define KEYWAY_INCOMPLETE_FACTOR_H
#include <petscksp.h>

struct incomplete_factor {
  KSP solver;   /* holds the factors */
  double shift; /* the factor is that of the matrix with 1 + shift times its diagonal */
};

/* Factors with the least shift, from 0.01 on, that leaves a positive definite preconditioner; a
 * shift that was needed before is kept. No shift may suffice, and the matrix may not be positive
 * definite. */
PetscErrorCode set_up_incomplete(struct incomplete_factor *self, Mat blocks, int *is_definite);

PetscErrorCode forget_incomplete(struct incomplete_factor *self);

/* The shift, where it is not that of most matrices; else 0. */
double unusual_shift(const struct incomplete_factor *self);

/* The next larger shift, for a factor that has failed in a solve; 0: there is none. */
int raise_shift(struct incomplete_factor *self);
#endif
