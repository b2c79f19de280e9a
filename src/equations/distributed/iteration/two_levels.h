/* The preconditioner of conjugate gradients: an incomplete factor for what neighbours do against
 * each other, and the motions of groups of nodes for the rest. */
#ifndef KEYWAY_TWO_LEVELS_H
#define KEYWAY_TWO_LEVELS_H
#include <petscksp.h>

#include "coarse_space.h"
#include "incomplete_factor.h"

struct two_levels {
  struct incomplete_factor fine;
  struct coarse_space coarse;
};

/* Gives a solver a matrix in blocks, and its preconditioner. */
PetscErrorCode set_up_two_levels(struct two_levels *self, KSP solver, Mat blocks,
                                 int *is_definite);

PetscErrorCode forget_two_levels(struct two_levels *self);
#endif
