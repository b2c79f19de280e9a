/* Behind arpack.f90 in the plain program: vectors are whole. */
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

void keyway_iterate_arpack(int is_divided, int *ido, int n, int nev, double tol, double *resid,
                           int ncv, double *v, int *iparam, int *ipntr, double *workd,
                           double *workl, int lworkl, int *info)
{
  (void)is_divided;
  dsaupd_(ido, "G", &n, "LM", &nev, &tol, resid, &ncv, v, &n, iparam, ipntr, workd, workl,
          &lworkl, info, 1, 2);
}

void keyway_extract_arpack(int is_divided, int *select, double *d, double *z, int n, int nev,
                           double tol, double *resid, int ncv, double *v, int *iparam, int *ipntr,
                           double *workd, double *workl, int lworkl, int *info)
{
  const int wants_vectors = 1;
  const double shift = 0.0;
  (void)is_divided;
  dseupd_(&wants_vectors, "A", select, d, z, &n, &shift, "G", &n, "LM", &nev, &tol, resid, &ncv, v,
          &n, iparam, ipntr, workd, workl, &lworkl, info, 1, 1, 2);
}
