/* Behind arpack.f90 with KEYWAY_PETSC: ARPACK for whole vectors, PARPACK for divided ones. */
#include <mpi.h>
#include <stddef.h>

/* ARPACK's procedures; Fortran appends the lengths of the words. */
void dsaupd_(int *ido, const char *bmat, const int *n, const char *which, const int *nev,
             const double *tol, double *resid, const int *ncv, double *v, const int *ldv,
             int *iparam, int *ipntr, double *workd, double *workl, const int *lworkl, int *info,
             size_t, size_t);
void dseupd_(const int *rvec, const char *howmny, int *select, double *d, double *z,
             const int *ldz, const double *sigma, const char *bmat, const int *n,
             const char *which, const int *nev, const double *tol, double *resid, const int *ncv,
             double *v, const int *ldv, int *iparam, int *ipntr, double *workd, double *workl,
             const int *lworkl, int *info, size_t, size_t, size_t);
void pdsaupd_(const int *comm, int *ido, const char *bmat, const int *n, const char *which,
              const int *nev, const double *tol, double *resid, const int *ncv, double *v,
              const int *ldv, int *iparam, int *ipntr, double *workd, double *workl,
              const int *lworkl, int *info, size_t, size_t);
void pdseupd_(const int *comm, const int *rvec, const char *howmny, int *select, double *d,
              double *z, const int *ldz, const double *sigma, const char *bmat, const int *n,
              const char *which, const int *nev, const double *tol, double *resid,
              const int *ncv, double *v, const int *ldv, int *iparam, int *ipntr, double *workd,
              double *workl, const int *lworkl, int *info, size_t, size_t, size_t);

void keyway_iterate_arpack(int is_divided, int *ido, int n, int nev, double tol, double *resid,
                           int ncv, double *v, int *iparam, int *ipntr, double *workd,
                           double *workl, int lworkl, int *info)
{
  if (is_divided) {
    const int comm = MPI_Comm_c2f(MPI_COMM_WORLD);
    pdsaupd_(&comm, ido, "G", &n, "LM", &nev, &tol, resid, &ncv, v, &n, iparam, ipntr, workd,
             workl, &lworkl, info, 1, 2);
  } else {
    dsaupd_(ido, "G", &n, "LM", &nev, &tol, resid, &ncv, v, &n, iparam, ipntr, workd, workl,
            &lworkl, info, 1, 2);
  }
}

void keyway_extract_arpack(int is_divided, int *select, double *d, double *z, int n, int nev,
                           double tol, double *resid, int ncv, double *v, int *iparam, int *ipntr,
                           double *workd, double *workl, int lworkl, int *info)
{
  const int wants_vectors = 1;
  const double shift = 0.0;
  if (is_divided) {
    const int comm = MPI_Comm_c2f(MPI_COMM_WORLD);
    pdseupd_(&comm, &wants_vectors, "A", select, d, z, &n, &shift, "G", &n, "LM", &nev, &tol,
             resid, &ncv, v, &n, iparam, ipntr, workd, workl, &lworkl, info, 1, 1, 2);
  } else {
    dseupd_(&wants_vectors, "A", select, d, z, &n, &shift, "G", &n, "LM", &nev, &tol, resid, &ncv,
            v, &n, iparam, ipntr, workd, workl, &lworkl, info, 1, 1, 2);
  }
}
