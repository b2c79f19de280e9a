/* A x_i = b_i holds to the tolerance of the solves. */
#include "last_solutions.h"

#include <math.h>

/* A pivot below this part of its diagonal: the right-hand side depends on newer ones. The normal
 * equations then keep 1e-6 of the coefficients. */
static const double dependent = 1e-10;

PetscErrorCode forget_solutions(struct last_solutions *self)
{
  PetscFunctionBegin;
  for (int i = 0; i < self->count; i++) {
    PetscCall(VecDestroy(&self->b[i]));
    PetscCall(VecDestroy(&self->x[i]));
  }
  self->count = 0;
  PetscFunctionReturn(0);
}

/* Solves the normal equations by Cholesky's method, the newest right-hand side first. */
static void find_weights(const struct last_solutions *self, const PetscScalar *with, double *weight)
{
  const int n = self->count;
  double factor[most_kept][most_kept], y[most_kept];
  int slot[most_kept], rank = 0;
  for (int k = 0; k < n; k++) {
    const int now = (self->newest - k + n) % n;
    double row[most_kept], rest = self->product[now][now];
    weight[now] = 0;
    for (int j = 0; j < rank; j++) {
      double sum = self->product[now][slot[j]];
      for (int m = 0; m < j; m++) sum -= row[m] * factor[j][m];
      row[j] = sum / factor[j][j];
      rest -= row[j] * row[j];
    }
    if (!(rest > dependent * self->product[now][now])) continue;
    for (int j = 0; j < rank; j++) factor[rank][j] = row[j];
    factor[rank][rank] = sqrt(rest);
    slot[rank++] = now;
  }
  for (int j = 0; j < rank; j++) {
    y[j] = with[slot[j]];
    for (int m = 0; m < j; m++) y[j] -= factor[j][m] * y[m];
    y[j] /= factor[j][j];
  }
  for (int j = rank - 1; j >= 0; j--) {
    for (int m = j + 1; m < rank; m++) y[j] -= factor[m][j] * weight[slot[m]];
    weight[slot[j]] = y[j] / factor[j][j];
  }
}

PetscErrorCode combine_solutions(struct last_solutions *self, Vec b, PetscScalar *with, Vec x)
{
  PetscScalar weight[most_kept];
  PetscFunctionBegin;
  PetscCall(VecSet(x, 0));
  if (self->count == 0) PetscFunctionReturn(0);
  PetscCall(VecMDot(b, self->count, self->b, with));
  find_weights(self, with, weight);
  PetscCall(VecMAXPY(x, self->count, weight, self->x));
  PetscFunctionReturn(0);
}

PetscErrorCode keep_solution(struct last_solutions *self, Vec b, const PetscScalar *with, Vec x)
{
  const int known = self->count;
  int slot = self->count;
  PetscFunctionBegin;
  if (slot < most_kept) {
    PetscCall(VecDuplicate(b, &self->b[slot]));
    PetscCall(VecDuplicate(x, &self->x[slot]));
    self->count++;
  } else {
    slot = (self->newest + 1) % most_kept;
  }
  for (int i = 0; i < known; i++) self->product[slot][i] = self->product[i][slot] = with[i];
  PetscCall(VecDot(b, b, &self->product[slot][slot]));
  PetscCall(VecCopy(b, self->b[slot]));
  PetscCall(VecCopy(x, self->x[slot]));
  self->newest = slot;
  PetscFunctionReturn(0);
}
