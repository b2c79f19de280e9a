/* A-DEF2 of J. M. Tang, R. Nabben, C. Vuik, Y. A. Erlangga, Journal of Scientific Computing 39,
 * 2009, 340-370: P^T M^-1 + Q, with M the incomplete factor and P^T = I - Q A. It is symmetric for
 * residuals r without a part in the coarse space: the iteration for a correction d of x, A d = r,
 * starts from d = Q r, and the residual stays so but for round-off, which Q takes away. */
#include "two_levels.h"

static PetscErrorCode apply_two_levels(PC pc, Vec r, Vec z)
{
  struct two_levels *self;
  PC fine;
  PetscFunctionBegin;
  PetscCall(PCShellGetContext(pc, &self));
  PetscCall(KSPGetPC(self->fine.solver, &fine));
  PetscCall(PCApply(fine, r, z));
  PetscCall(correct_coarse(&self->coarse, r, z));
  PetscFunctionReturn(0);
}

PetscErrorCode set_up_two_levels(struct two_levels *self, KSP solver, Mat blocks,
                                 int *is_definite)
{
  PC pc;
  PetscFunctionBegin;
  PetscCall(set_up_coarse(&self->coarse, blocks, is_definite));
  if (*is_definite) PetscCall(set_up_incomplete(&self->fine, blocks, is_definite));
  PetscCall(KSPSetOperators(solver, blocks, blocks));
  PetscCall(KSPGetPC(solver, &pc));
  PetscCall(PCSetType(pc, PCSHELL));
  PetscCall(PCShellSetContext(pc, self));
  PetscCall(PCShellSetApply(pc, apply_two_levels));
  PetscFunctionReturn(0);
}

PetscErrorCode forget_two_levels(struct two_levels *self)
{
  PetscFunctionBegin;
  PetscCall(forget_incomplete(&self->fine));
  PetscCall(forget_coarse(&self->coarse));
  PetscFunctionReturn(0);
}
