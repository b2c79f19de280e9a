/* A factor of CHOLMOD with what our own work on its supernodes needs. */
#ifndef KEYWAY_CHOLMOD_FACTOR_H
#define KEYWAY_CHOLMOD_FACTOR_H
#include "selected_inverse.h"
#include "subtrees.h"
#include "supernodal_solve.h"
#include <cholmod.h>

struct keyway_cholmod {
  cholmod_common common;
  cholmod_factor *factor;
  cholmod_dense *x, *y, *e; /* workspace of the solves */
  char *is_upper;           /* (supernodes) the part of the active unknowns; NULL: not chosen */
  double *work;             /* (n) */
  struct keyway_subtrees trees;
  /* The top of the factor: supernodes with chosen unknowns, and all their ancestors. */
  char *is_top;
  int *super_of, *place_of;
  double *top_work;
  struct keyway_inverse inverse; /* in the pattern of the top */
  /* The factor with its lower part in single precision; NULL: CHOLMOD has all of it. */
  float *single;
  size_t num_single;
  double *rest;     /* the supernodes in double precision */
  long *part_start; /* of each supernode in `single`, or -1 - that in `rest` */
  /* A copy of the whole factor in single precision; NULL: there is none. */
  float *copy;
  long *copy_start; /* of each supernode */
};

/* Frees the top. */
void keyway_free_top(struct keyway_cholmod *c);

/* The supernodes of the factor, as it is held. */
struct keyway_supernodes keyway_supernodes_of(const struct keyway_cholmod *c);

/* The supernodes of the copy in single precision. */
struct keyway_supernodes keyway_supernodes_of_copy(const struct keyway_cholmod *c);

/* Frees what is held in single precision. */
void keyway_free_single(struct keyway_cholmod *c);

#endif
