/* Behind arpack.f90 in the plain program: vectors are whole. */
#include "whole_arpack.h"

void keyway_iterate_arpack(int is_divided, int *ido, int n, int nev, double tol, double *resid,
                           int ncv, double *v, int *iparam, int *ipntr, double *workd,
                           double *workl, int lworkl, int *info)
{
  (void)is_divided;
  iterate_whole(ido, n, nev, tol, resid, ncv, v, iparam, ipntr, workd, workl, lworkl, info);
}

void keyway_extract_arpack(int is_divided, int *choice, double *d, double *z, int n, int nev,
                           double tol, double *resid, int ncv, double *v, int *iparam, int *ipntr,
                           double *workd, double *workl, int lworkl, int *info)
{
  (void)is_divided;
  extract_whole(choice, d, z, n, nev, tol, resid, ncv, v, iparam, ipntr, workd, workl, lworkl,
                info);
}
