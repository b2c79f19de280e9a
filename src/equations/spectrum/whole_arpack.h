/* ARPACK for whole vectors. Fortran appends the lengths of the words. */
#include <stddef.h>

void dsaupd_(int *ido, const char *bmat, const int *n, const char *which, const int *nev,
             const double *tol, double *resid, const int *ncv, double *v, const int *ldv,
             int *iparam, int *ipntr, double *workd, double *workl, const int *lworkl, int *info,
             size_t, size_t);
void dseupd_(const int *rvec, const char *howmny, int *choice, double *d, double *z,
             const int *ldz, const double *sigma, const char *bmat, const int *n,
             const char *which, const int *nev, const double *tol, double *resid, const int *ncv,
             double *v, const int *ldv, int *iparam, int *ipntr, double *workd, double *workl,
             const int *lworkl, int *info, size_t, size_t, size_t);

static const int wants_vectors = 1;
static const double no_shift = 0.0;

static void iterate_whole(int *ido, int n, int nev, double tol, double *resid, int ncv, double *v,
                          int *iparam, int *ipntr, double *workd, double *workl, int lworkl,
                          int *info)
{
  dsaupd_(ido, "G", &n, "LM", &nev, &tol, resid, &ncv, v, &n, iparam, ipntr, workd, workl,
          &lworkl, info, 1, 2);
}

static void extract_whole(int *choice, double *d, double *z, int n, int nev, double tol,
                          double *resid, int ncv, double *v, int *iparam, int *ipntr,
                          double *workd, double *workl, int lworkl, int *info)
{
  dseupd_(&wants_vectors, "A", choice, d, z, &n, &no_shift, "G", &n, "LM", &nev, &tol, resid,
          &ncv, v, &n, iparam, ipntr, workd, workl, &lworkl, info, 1, 1, 2);
}
