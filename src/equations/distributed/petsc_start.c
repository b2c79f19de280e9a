#include "petsc_start.h"

static PetscErrorCode keep_quiet(MPI_Comm comm, int line, const char *function, const char *file,
                                 PetscErrorCode code, PetscErrorType type, const char *text,
                                 void *context)
{
  (void)comm, (void)line, (void)function, (void)file, (void)type, (void)text, (void)context;
  return code;
}

/* An option that the user has not set in PETSC_OPTIONS. */
static PetscErrorCode set_default(const char *name, const char *value)
{
  PetscBool is_set;
  PetscFunctionBegin;
  PetscCall(PetscOptionsHasName(NULL, NULL, name, &is_set));
  if (!is_set) PetscCall(PetscOptionsSetValue(NULL, name, value));
  PetscFunctionReturn(0);
}

/* Signals are the program's, and PETSc's help on errors is not for its users. */
PetscErrorCode start_petsc(void)
{
  PetscBool is_started;
  PetscFunctionBegin;
  PetscCall(PetscInitialized(&is_started));
  if (is_started) PetscFunctionReturn(0);
  PetscCall(PetscOptionsSetValue(NULL, "-no_signal_handler", "true"));
  PetscCall(PetscInitializeNoArguments());
  PetscCall(PetscPushErrorHandler(keep_quiet, NULL));
  PetscCall(set_default("-keyway_sub_pc_type", "icc"));
  PetscFunctionReturn(0);
}
