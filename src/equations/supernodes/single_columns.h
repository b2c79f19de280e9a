/* Substitution with the columns of one supernode in single precision; all sums are in double. */
#ifndef KEYWAY_SINGLE_COLUMNS_H
#define KEYWAY_SINGLE_COLUMNS_H

/* t (length): the first `width` entries become L^-1 t, the others lose the products with them. */
void keyway_forward_columns(int width, int length, const float *value, double *t);

/* t (length): the first `width` entries become the solution of L^T x = t with the others given. */
void keyway_backward_columns(int width, int length, const float *value, double *t);

#endif
