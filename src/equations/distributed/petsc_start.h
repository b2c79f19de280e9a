/* Starts PETSc for this program. */
#ifndef KEYWAY_PETSC_START_H
#define KEYWAY_PETSC_START_H
#include <petscsys.h>

/* Does nothing where PETSc has started. */
PetscErrorCode start_petsc(void);
#endif
