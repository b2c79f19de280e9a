/* A factor L L^T in supernodes: dense blocks of columns with the same rows. */
#ifndef KEYWAY_SUPERNODAL_SOLVE_H
#define KEYWAY_SUPERNODAL_SOLVE_H

struct keyway_supernodes {
  int num_supernodes;
  const int *column;      /* (num_supernodes + 1) first column of each */
  const int *row_start;   /* (num_supernodes + 1) into row */
  const int *value_start; /* (num_supernodes + 1) into value */
  const int *row;         /* rows of each, its own columns first */
  const double *value;    /* dense blocks by columns; the upper triangle is not used */
  /* Where a part of the blocks is held in single precision; NULL: all blocks are in `value`. */
  const float *single;
  const long *part_start; /* of each block in `single`; -1 - p: at p in `value` */
};

/* Parts of a factor. The upper part holds the supernodes of chosen unknowns and all that are
 * eliminated after and depend on them; the lower part is the rest. */
enum keyway_part { KEYWAY_WHOLE = 0, KEYWAY_LOWER = 1, KEYWAY_UPPER = 2 };

/* is_upper (num_supernodes): marks the upper part of the chosen columns. Returns its share of the
 * values of the factor. */
double keyway_mark_upper(const struct keyway_supernodes *l, int count, const int *column,
                         char *is_upper);

int keyway_is_in_part(int s, enum keyway_part part, const char *is_upper);

/* Forward substitution with the columns of one supernode: their part of y, and behind it in `work`
 * what the other rows of the supernode get. work has room for its rows. */
void keyway_forward_one(const struct keyway_supernodes *l, int s, double *y, double *work);

/* The same; the other rows of y get their share. */
void keyway_forward_and_add(const struct keyway_supernodes *l, int s, double *y, double *work);

/* Backward substitution with the columns of one supernode. */
void keyway_backward_one(const struct keyway_supernodes *l, int s, double *y, double *work);

/* y = L^-1 y on the supernodes of a part; work has room for a column. is_upper may be
 * NULL for the whole factor. */
void keyway_substitute_forward(const struct keyway_supernodes *l, enum keyway_part part,
                               const char *is_upper, double *y, double *work);

/* y = L^-T y on the supernodes of a part. */
void keyway_substitute_backward(const struct keyway_supernodes *l, enum keyway_part part,
                                const char *is_upper, double *y, double *work);

#endif
