/* Behind arpack.f90 with KEYWAY_PETSC: ARPACK for whole vectors, PARPACK for divided ones. */
#include <mpi.h>
#include "whole_arpack.h"

void pdsaupd_(const int *comm, int *ido, const char *bmat, const int *n, const char *which,
              const int *nev, const double *tol, double *resid, const int *ncv, double *v,
              const int *ldv, int *iparam, int *ipntr, double *workd, double *workl,
              const int *lworkl, int *info, size_t, size_t);
void pdseupd_(const int *comm, const int *rvec, const char *howmny, int *choice, double *d,
              double *z, const int *ldz, const double *sigma, const char *bmat, const int *n,
              const char *which, const int *nev, const double *tol, double *resid,
              const int *ncv, double *v, const int *ldv, int *iparam, int *ipntr, double *workd,
              double *workl, const int *lworkl, int *info, size_t, size_t, size_t);

void keyway_iterate_arpack(int is_divided, int *ido, int n, int nev, double tol, double *resid,
                           int ncv, double *v, int *iparam, int *ipntr, double *workd,
                           double *workl, int lworkl, int *info)
{
  const int comm = MPI_Comm_c2f(MPI_COMM_WORLD);
  if (is_divided)
    pdsaupd_(&comm, ido, "G", &n, "LM", &nev, &tol, resid, &ncv, v, &n, iparam, ipntr, workd,
             workl, &lworkl, info, 1, 2);
  else
    iterate_whole(ido, n, nev, tol, resid, ncv, v, iparam, ipntr, workd, workl, lworkl, info);
}

void keyway_extract_arpack(int is_divided, int *choice, double *d, double *z, int n, int nev,
                           double tol, double *resid, int ncv, double *v, int *iparam, int *ipntr,
                           double *workd, double *workl, int lworkl, int *info)
{
  const int comm = MPI_Comm_c2f(MPI_COMM_WORLD);
  if (is_divided)
    pdseupd_(&comm, &wants_vectors, "A", choice, d, z, &n, &no_shift, "G", &n, "LM", &nev, &tol,
             resid, &ncv, v, &n, iparam, ipntr, workd, workl, &lworkl, info, 1, 1, 2);
  else
    extract_whole(choice, d, z, n, nev, tol, resid, ncv, v, iparam, ipntr, workd, workl, lworkl,
                  info);
}
