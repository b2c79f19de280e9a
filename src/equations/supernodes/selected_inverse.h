/* Entries of the inverse of L L^T in the pattern of some supernodes of L, the top: with a supernode
 * it has all its ancestors. */
#ifndef KEYWAY_SELECTED_INVERSE_H
#define KEYWAY_SELECTED_INVERSE_H
#include "supernodal_solve.h"

/* The inverse Z, supernode by supernode, from the last to the first. */
struct keyway_inverse {
  double **block; /* (supernodes) Z in the pattern of each; NULL: not held */
  int *first;     /* (supernodes) the first descendant in the top, or itself */
  int *pending;   /* (supernodes) expected uses of unknowns of its columns */
  char *held;     /* (supernodes) work */
  int next;       /* the last supernode that is not inverted yet */
};

/* Starts without blocks. Returns 0 for success. */
int keyway_start_inverse(const struct keyway_supernodes *l, const int *super_of, const char *is_top,
                         struct keyway_inverse *z);

/* Inverts the supernodes of the top down to one. Returns 0 for success. */
int keyway_invert_down_to(const struct keyway_supernodes *l, const int *super_of,
                          const char *is_top, int first, struct keyway_inverse *z);

/* Frees the blocks whose descendants are inverted and of which no use is expected: neither of their
 * own unknowns nor of those of their ancestors, which are the rows of a block. */
void keyway_release_blocks(const struct keyway_supernodes *l, const int *super_of,
                           struct keyway_inverse *z);

/* Entries of Z for pairs of unknowns, given in the order of elimination; entries outside of the
 * pattern, or not held, are zero. Returns their number, or -1 without memory. */
int keyway_inverse_entries(const struct keyway_supernodes *l, const int *super_of,
                           const struct keyway_inverse *z, int rows, const int *row, int columns,
                           const int *column, double *block);

/* Frees all. */
void keyway_free_inverse(int num_supernodes, struct keyway_inverse *z);
#endif
