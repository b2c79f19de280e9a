/* The last solutions of one matrix, from which the next iteration starts. */
#ifndef KEYWAY_LAST_SOLUTIONS_H
#define KEYWAY_LAST_SOLUTIONS_H
#include <petscvec.h>

enum { most_kept = 6 };

struct last_solutions {
  int count, newest;
  Vec b[most_kept], x[most_kept];           /* right-hand sides and their solutions */
  PetscScalar product[most_kept][most_kept]; /* b_i . b_j */
};

/* Forgets the solutions, with a new matrix. */
PetscErrorCode forget_solutions(struct last_solutions *self);

/* x = sum c_i x_i, c from the least squares of b - sum c_i b_i. `with` returns b . b_i. */
PetscErrorCode combine_solutions(struct last_solutions *self, Vec b, PetscScalar *with, Vec x);

/* Keeps a solution in place of the oldest one. */
PetscErrorCode keep_solution(struct last_solutions *self, Vec b, const PetscScalar *with, Vec x);
#endif
