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

/* The supernode of the first row below a supernode, its parent in the elimination tree; or -1. */
static int parent_of(const struct keyway_supernodes *l, const int *super_of, int s)
{
  int below = l->row_start[s] + l->column[s + 1] - l->column[s];
  return below < l->row_start[s + 1] ? super_of[l->row[below]] : -1;
}

/* Notes the place of each row of a supernode among its rows, -1 elsewhere. */
static void note_places(const struct keyway_supernodes *l, int s, int *place, int is_set)
{
  int first = l->row_start[s];
  for (int i = first; i < l->row_start[s + 1]; i++) place[l->row[i]] = is_set ? i - first : -1;
}

/* The lower triangle of Z on the rows below a supernode, from the supernodes of these rows. */
static void gather(const struct keyway_supernodes *l, const int *super_of, double *const *z,
                   int below, const int *row, int *place, double *block)
{
  int last = -1;
  for (int b = 0; b < below; b++) {
    int s = super_of[row[b]], height = l->row_start[s + 1] - l->row_start[s];
    const double *column = z[s] + (long)(row[b] - l->column[s]) * height;
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
static int invert_one(const struct keyway_supernodes *l, const int *super_of, int s, double **z,
                      int *place)
{
  int columns = l->column[s + 1] - l->column[s], rows = l->row_start[s + 1] - l->row_start[s], info;
  int below = rows - columns;
  double *own, *known = NULL, *y = NULL;
  own = z[s] = malloc((size_t)rows * (size_t)columns * sizeof *own);
  if (!own) return -2;
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
    gather(l, super_of, z, below, l->row + l->row_start[s] + columns, place, known);
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

int keyway_start_inverse(const struct keyway_supernodes *l, const int *super_of, const char *is_top,
                         struct keyway_inverse *z)
{
  size_t n = (size_t)l->num_supernodes;
  z->next = l->num_supernodes - 1;
  z->block = calloc(n, sizeof *z->block);
  z->first = malloc(n * sizeof *z->first);
  z->pending = calloc(n, sizeof *z->pending);
  z->held = malloc(n);
  if (!z->block || !z->first || !z->pending || !z->held) return -2;
  for (int s = 0; s < l->num_supernodes; s++) z->first[s] = s;
  for (int s = 0; s < l->num_supernodes; s++) {
    int parent = is_top[s] ? parent_of(l, super_of, s) : -1;
    if (parent >= 0 && z->first[s] < z->first[parent]) z->first[parent] = z->first[s];
  }
  return 0;
}

int keyway_invert_down_to(const struct keyway_supernodes *l, const int *super_of,
                          const char *is_top, int first, struct keyway_inverse *z)
{
  int n = l->column[l->num_supernodes], status = 0;
  int *place = malloc((size_t)n * sizeof *place);
  if (!place) return -2;
  for (int i = 0; i < n; i++) place[i] = -1;
  for (; z->next >= first && status == 0; z->next--)
    if (is_top[z->next]) status = invert_one(l, super_of, z->next, z->block, place);
  free(place);
  return status;
}

void keyway_release_blocks(const struct keyway_supernodes *l, const int *super_of,
                           struct keyway_inverse *z)
{
  for (int s = l->num_supernodes - 1; s > z->next; s--) {
    int parent = parent_of(l, super_of, s);
    z->held[s] = z->pending[s] > 0 || (parent >= 0 && z->held[parent]);
    if (z->held[s] || z->next >= z->first[s]) continue;
    free(z->block[s]);
    z->block[s] = NULL;
  }
}

void keyway_free_inverse(int num_supernodes, struct keyway_inverse *z)
{
  for (int s = 0; z->block && s < num_supernodes; s++) free(z->block[s]);
  free(z->block);
  free(z->first);
  free(z->pending);
  free(z->held);
  memset(z, 0, sizeof *z);
}

int keyway_inverse_entries(const struct keyway_supernodes *l, const int *super_of,
                           const struct keyway_inverse *z, int rows, const int *row, int columns,
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
      const double *values = z->block[s];
      if (values) values += (long)(outer[b] - l->column[s]) * height;
      if (s != last) {
        if (last >= 0) note_places(l, last, place, 0);
        note_places(l, s, place, 1);
        last = s;
      }
      for (int a = 0; a < num_inner; a++) {
        double *entry = pass ? block + (long)a * rows + b : block + (long)b * rows + a;
        int is_known = values && place[inner[a]] >= 0;
        if (inner[a] < outer[b] || (pass && inner[a] == outer[b])) continue;
        missing += !is_known;
        *entry = is_known ? values[place[inner[a]]] : 0.0;
      }
    }
    if (last >= 0) note_places(l, last, place, 0);
  }
  free(place);
  return missing;
}
