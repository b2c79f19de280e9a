/* Subtrees of the elimination tree: supernodes of different subtrees do not need each other, so
 * that threads substitute in them at the same time (Liu, SIAM J. Matrix Anal. Appl. 11, 1990,
 * 134-172). What is above the subtrees is left to one thread. */
#ifndef KEYWAY_SUBTREES_H
#define KEYWAY_SUBTREES_H
#include "supernodal_solve.h"

struct keyway_subtrees {
  int num_trees;   /* 0: one thread does everything */
  int num_threads; /* that there is room for */
  int *root;       /* (num_trees) supernode, the largest tree first */
  int *first;      /* (num_trees) the tree holds the supernodes first to root */
  long *sum_start; /* (num_trees + 1) into `sum` */
  double *sum;     /* of each tree for the rows above it */
  char *is_above;  /* (supernodes) in no tree */
  int *place;      /* (threads, n) of a row above the tree in the sums of the tree */
  double *work;    /* (threads, longest) */
  int longest;     /* rows of a supernode, at most */
};

/* Chooses subtrees, and makes room for some threads. There are none where they would not make a
 * substitution faster, for small factors, and without memory. */
void keyway_plan_subtrees(const struct keyway_supernodes *l, int num_threads,
                          struct keyway_subtrees *trees);

void keyway_free_subtrees(struct keyway_subtrees *trees);

/* y = L^-1 y on the supernodes of a part, as keyway_substitute_forward. The sums do not depend on
 * which thread takes which tree. */
void keyway_forward_in_trees(const struct keyway_supernodes *l, enum keyway_part part,
                             const char *is_upper, const struct keyway_subtrees *trees, double *y);

/* y = L^-T y on the supernodes of a part. */
void keyway_backward_in_trees(const struct keyway_supernodes *l, enum keyway_part part,
                              const char *is_upper, const struct keyway_subtrees *trees,
                              double *y);

#endif
