/* Behind petsc_equations.f90 in the plain program, which has one rank and never calls these. */
#include <stddef.h>

enum { failed = 3 };

int keyway_has_petsc(void) { return 0; }
void *keyway_petsc_start(void) { return NULL; }
void keyway_petsc_finish(void *handle) { (void)handle; }

int keyway_petsc_plan(void *handle, int method, int rows, const double *rigid, size_t entries,
                      int *row, int *column)
{
  (void)handle, (void)method, (void)rows, (void)rigid, (void)entries, (void)row, (void)column;
  return failed;
}

int keyway_petsc_sum(void *handle, const double *values)
{
  (void)handle, (void)values;
  return failed;
}

int keyway_petsc_factor(void *handle)
{
  (void)handle;
  return failed;
}

double keyway_petsc_entries(void *handle)
{
  (void)handle;
  return 0;
}

double keyway_petsc_shift(void *handle)
{
  (void)handle;
  return 0;
}

void keyway_petsc_memory(void *handle, int *memory)
{
  (void)handle;
  memory[0] = memory[1] = 0;
}

int keyway_petsc_solve(void *handle, int rows, int sides, double admissible, double *b,
                       int *iterations)
{
  (void)handle, (void)rows, (void)sides, (void)admissible, (void)b, (void)iterations;
  return failed;
}

int keyway_petsc_patch(void *handle, int layers, int most, int count, const int *seed, int *rows)
{
  (void)handle, (void)layers, (void)most, (void)count, (void)seed;
  *rows = 0;
  return failed;
}

void keyway_petsc_drop_patch(void *handle) { (void)handle; }

int keyway_petsc_patch_rows(void *handle, int rows, int *row)
{
  (void)handle, (void)rows, (void)row;
  return failed;
}

int keyway_petsc_solve_patch(void *handle, int rows, int sides, double *b)
{
  (void)handle, (void)rows, (void)sides, (void)b;
  return failed;
}
