/* Groups of nodes that are stiff against each other, among the rows of one rank. */
#ifndef KEYWAY_NODE_GROUPS_H
#define KEYWAY_NODE_GROUPS_H
#include <petscmat.h>

/* Divides the own nodes of a matrix, three rows each, into about `count` groups of one size;
 * group_of_node, from 0, is for the caller to free (PetscFree). */
PetscErrorCode find_node_groups(Mat rows, int count, int **group_of_node);
#endif
