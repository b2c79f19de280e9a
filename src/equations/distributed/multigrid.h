/* Multigrid by smoothed aggregation (GAMG of PETSc), for three rows of each node. */
#ifndef KEYWAY_MULTIGRID_H
#define KEYWAY_MULTIGRID_H
#include <petscksp.h>

#include "incomplete_factor.h"

/* Gives a matrix the motions of a rigid body at its own rows, which each level must represent. */
PetscErrorCode give_rigid_motions(Mat matrix, int rows, const double *rigid);

/* Makes the levels from a matrix by rows. The iteration and the smoother of the finest level take
 * the same matrix in blocks, the smoother with its incomplete factor. */
PetscErrorCode set_up_multigrid(KSP solver, Mat rows, Mat blocks, struct incomplete_factor *factor,
                                int *is_definite);

/* Gives the finest level a factor with a larger shift. */
PetscErrorCode renew_smoother(KSP solver, Mat blocks, struct incomplete_factor *factor,
                              int *is_definite);
#endif
