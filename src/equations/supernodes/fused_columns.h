/* Substitution with the columns of one supernode in double or single precision; all sums are in
 * double precision. */
#ifndef KEYWAY_FUSED_COLUMNS_H
#define KEYWAY_FUSED_COLUMNS_H

/* t (length): the first `width` entries become L^-1 t, the others lose the products with them. */
void keyway_forward_double(int width, int length, const double *value, double *t);
void keyway_forward_single(int width, int length, const float *value, double *t);

/* t (length): the first `width` entries become the solution of L^T x = t with the others given. */
void keyway_backward_double(int width, int length, const double *value, double *t);
void keyway_backward_single(int width, int length, const float *value, double *t);

#endif
