/* Entries of the inverse of L L^T in the pattern of some supernodes of L. */
#ifndef KEYWAY_SELECTED_INVERSE_H
#define KEYWAY_SELECTED_INVERSE_H
#include "supernodal_solve.h"

int keyway_invert(const struct keyway_supernodes *l, const int *super_of, const long *pz, double *z);
int keyway_inverse_entries(const struct keyway_supernodes *l, const int *super_of, const long *pz,
                           const double *z, int rows, const int *row, int columns,
                           const int *column, double *block);
#endif
