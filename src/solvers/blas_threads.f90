!> Threads of the BLAS: many for factors, one elsewhere.
!>
!> OpenBLAS's workers spin between calls and starve OpenMP, so they are woken only where they pay.
module blas_threads
  use, intrinsic :: iso_c_binding, only: c_int
  use omp_lib, only: omp_get_max_threads
  implicit none
  private
  public :: use_many_threads, use_one_thread

  interface
    subroutine keyway_set_blas_threads(threads) bind(c)
      import :: c_int
      implicit none
      integer(c_int), value :: threads
    end subroutine keyway_set_blas_threads
  end interface

contains

  !> As many as OpenMP has been given.
  subroutine use_many_threads()
    call keyway_set_blas_threads(int(omp_get_max_threads(), c_int))
  end subroutine use_many_threads

  subroutine use_one_thread()
    call keyway_set_blas_threads(1_c_int)
  end subroutine use_one_thread
end module blas_threads
