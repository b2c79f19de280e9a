/* Selected inversion: the entries of (L L^T)^-1 in the pattern of some supernodes of L
 * (Takahashi, Fagan & Chin 1973, with supernodes as Lin et al. 2011).
 *
 * The inverse Z is held like L: for a supernode with the columns J and the rows R below,
 *   Z_RJ = -Z_RR Y,   Z_JJ = (L_JJ L_JJ^T)^-1 - Y^T Z_RJ,   Y = L_RJ L_JJ^-1.
 * Z_RR is known from the ancestors. */
#include "selected_inverse.h"
#include <stdlib.h>
#include <string.h>

void dtrsm_(const char *side, const char *uplo, const char *trans, const char *diag, const int *m,
            const int *n, const double *alpha, const double *a, const int *lda, double *b,
            const int *ldb, size_t, size_t, size_t, size_t);
void dsymm_(const char *side, const char *uplo, const int *m, const int *n, const double *alpha,
            const double *a, const int *lda, const double *b, const int *ldb, const double *beta,
            double *c, const int *ldc, size_t, size_t);
void dgemm_(const char *a_form, const char *b_form, const int *m, const int *n, const int *k,
            const double *alpha, const double *a, const int *lda, const double *b, const int *ldb,
            const double *beta, double *c, const int *ldc, size_t, size_t);
void dpotri_(const char *uplo, const int *n, double *a, const int *lda, int *info, size_t);

static const double one = 1.0, zero = 0.0, minus = -1.0;

/* Notes the place of each row of a supernode among its rows, -1 elsewhere. */
static void note_places(const struct keyway_supernodes *l, int s, int *place, int is_set)
{
  for (int i = l->row_start[s]; i < l->row_start[s + 1]; i++) place[l->row[i]] = is_set ? i - l->row_start[s] : -1;
}

/* The lower triangle of Z on the rows below a supernode, from the supernodes of these rows. */
static void gather(const struct keyway_supernodes *l, const int *super_of, const long *pz, const double *z,
                   int below, const int *row, int *place, double *block)
{
  int last = -1;
  for (int b = 0; b < below; b++) {
    int s = super_of[row[b]], height = l->row_start[s + 1] - l->row_start[s];
    const double *column = z + pz[s] + (long)(row[b] - l->column[s]) * height;
    if (s != last) {
      if (last >= 0) note_places(l, last, place, 0);
      note_places(l, s, place, 1);
      last = s;
    }
    for (int a = b; a < below; a++) block[(long)b * below + a] = column[place[row[a]]];
  }
  if (last >= 0) note_places(l, last, place, 0);
}

/* Z of one supernode, in place of a copy of its L. */
static int invert_one(const struct keyway_supernodes *l, const int *super_of, int s, const long *pz,
                      double *z, int *place)
{
  int columns = l->column[s + 1] - l->column[s], rows = l->row_start[s + 1] - l->row_start[s], info;
  int below = rows - columns;
  double *own = z + pz[s], *known = NULL, *y = NULL;
  memcpy(own, l->value + l->value_start[s], (size_t)rows * (size_t)columns * sizeof *own);
  if (below > 0) {
    known = malloc((size_t)below * (size_t)below * sizeof *known);
    y = malloc((size_t)below * (size_t)columns * sizeof *y);
    if (!known || !y) {
      free(known);
      free(y);
      return -2;
    }
    dtrsm_("R", "L", "N", "N", &below, &columns, &one, own, &rows, own + columns, &rows, 1, 1, 1, 1);
    for (int j = 0; j < columns; j++)
      memcpy(y + (size_t)j * (size_t)below, own + columns + (size_t)j * (size_t)rows,
             (size_t)below * sizeof *y);
    gather(l, super_of, pz, z, below, l->row + l->row_start[s] + columns, place, known);
    dsymm_("L", "L", &below, &columns, &minus, known, &below, y, &below, &zero, own + columns, &rows,
           1, 1);
  }
  dpotri_("L", &columns, own, &rows, &info, 1);
  if (below > 0)
    dgemm_("T", "N", &columns, &columns, &below, &minus, y, &below, own + columns, &rows, &one, own,
           &rows, 1, 1);
  free(known);
  free(y);
  return info;
}

/* Z of the supernodes that have a place in z, from the last to the first; with a supernode all its
 * ancestors have one. Returns 0 for success. */
int keyway_invert(const struct keyway_supernodes *l, const int *super_of, const long *pz, double *z)
{
  int n = l->column[l->num_supernodes], status = 0;
  int *place = malloc((size_t)n * sizeof *place);
  if (!place) return -2;
  for (int i = 0; i < n; i++) place[i] = -1;
  for (int s = l->num_supernodes - 1; s >= 0 && status == 0; s--)
    if (pz[s] >= 0) status = invert_one(l, super_of, s, pz, z, place);
  free(place);
  return status;
}

/* Entries of Z for pairs of unknowns, given in the order of elimination; entries outside of the
 * pattern are zero. Returns their number, or -1 without memory. */
int keyway_inverse_entries(const struct keyway_supernodes *l, const int *super_of, const long *pz,
                           const double *z, int rows, const int *row, int columns,
                           const int *column, double *block)
{
  int n = l->column[l->num_supernodes], missing = 0;
  int *place = malloc((size_t)n * sizeof *place);
  if (!place) return -1;
  for (int i = 0; i < n; i++) place[i] = -1;
  for (int pass = 0; pass < 2; pass++) { /* entries below, then above the diagonal of Z */
    const int *outer = pass ? row : column, *inner = pass ? column : row;
    int num_outer = pass ? rows : columns, num_inner = pass ? columns : rows, last = -1;
    for (int b = 0; b < num_outer; b++) {
      int s = super_of[outer[b]], height = l->row_start[s + 1] - l->row_start[s];
      const double *values;
      if (pz[s] < 0) continue;
      values = z + pz[s] + (long)(outer[b] - l->column[s]) * height;
      if (s != last) {
        if (last >= 0) note_places(l, last, place, 0);
        note_places(l, s, place, 1);
        last = s;
      }
      for (int a = 0; a < num_inner; a++) {
        double *entry = pass ? block + (long)a * rows + b : block + (long)b * rows + a;
        if (inner[a] < outer[b] || (pass && inner[a] == outer[b])) continue;
        missing += place[inner[a]] < 0;
        *entry = place[inner[a]] < 0 ? 0.0 : values[place[inner[a]]];
      }
    }
    if (last >= 0) note_places(l, last, place, 0);
  }
  free(place);
  return missing;
}
