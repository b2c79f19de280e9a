/* The motions of groups of nodes as rigid bodies, and the exact solution among these motions. */
#ifndef KEYWAY_COARSE_SPACE_H
#define KEYWAY_COARSE_SPACE_H
#include <petscksp.h>

enum { num_rigid = 6 };

struct coarse_space {
  double *rigid;   /* (own rows, 6) motions of a rigid body, until the groups are found */
  Mat motions;     /* W (rows, motions of groups), columns orthonormal */
  Mat forces;      /* A W */
  KSP solver;      /* of W^T A W */
  Vec load, answer; /* of the motions */
};

/* Keeps the motions of a rigid body at the own rows. */
PetscErrorCode keep_rigid_motions(struct coarse_space *self, int rows, const double *rigid);

/* A new matrix in blocks; the first one gives the groups. It is singular where W^T A W has no
 * factor. */
PetscErrorCode set_up_coarse(struct coarse_space *self, Mat blocks, int *is_definite);

/* x += Q r, Q = W (W^T A W)^-1 W^T. */
PetscErrorCode add_coarse_solution(struct coarse_space *self, Vec r, Vec x);

/* z += Q (r - A z), without a product with A. */
PetscErrorCode correct_coarse(struct coarse_space *self, Vec r, Vec z);

PetscErrorCode forget_coarse(struct coarse_space *self);
#endif
