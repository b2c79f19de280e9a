!> Threads and kernels of the BLAS: many threads for factors, one for all other work.
!>
!> Threads of OpenBLAS spin between calls and slow down OpenMP, so only factors use them.
module blas_threads
  use, intrinsic :: iso_c_binding, only: c_char, c_int, c_null_char
  use omp_lib, only: omp_get_max_active_levels, omp_get_max_threads, omp_set_max_active_levels
  implicit none
  private
  public :: use_many_threads, use_one_thread, restart_with_fast_libraries, warm_up_blas
  public :: kernels_of_blas

  integer, parameter :: longest_name = 64

  interface
    subroutine keyway_set_blas_threads(threads) bind(c)
      import :: c_int
      implicit none
      integer(c_int), value :: threads
    end subroutine keyway_set_blas_threads

    !> Lets the BLAS take its memory for so many threads.
    subroutine warm_up_blas(threads) bind(c, name='keyway_warm_up_blas')
      import :: c_int
      implicit none
      integer(c_int), value :: threads
    end subroutine warm_up_blas

    function keyway_blas_uses_openmp() result(answer) bind(c)
      import :: c_int
      implicit none
      integer(c_int) :: answer
    end function keyway_blas_uses_openmp

    subroutine keyway_blas_kernels(name, room) bind(c)
      import :: c_char, c_int, longest_name
      implicit none
      character(kind=c_char), intent(out) :: name(longest_name)
      integer(c_int), value :: room
    end subroutine keyway_blas_kernels

    !> Restarts the program if OpenBLAS does not know the processor or if idle threads would keep
    !> their cores busy; must be the first call of the program.
    subroutine restart_with_fast_libraries(threads) &
      bind(c, name='keyway_restart_with_fast_libraries')
      import :: c_int
      implicit none
      integer(c_int), value :: threads !< that the user has chosen, 0: all
    end subroutine restart_with_fast_libraries
  end interface

contains

  !> The kernels that OpenBLAS has chosen for this processor; 'unknown' for another library.
  function kernels_of_blas() result(text)
    character(:), allocatable :: text
    character(kind=c_char) :: name(longest_name)
    integer :: i
    call keyway_blas_kernels(name, int(longest_name, c_int))
    text = ''
    do i = 1, longest_name
      if (name(i) == c_null_char) exit
      text = text//name(i)
    end do
    if (text == '') text = 'unknown'
  end function kernels_of_blas

  !> Gives the BLAS as many threads as OpenMP has. CHOLMOD must not open teams of threads: these
  !> have four threads regardless of the user's number, and doubled the processor time of a factor.
  subroutine use_many_threads(levels)
    integer, intent(out) :: levels !< of OpenMP, for `use_one_thread`
    levels = omp_get_max_active_levels()
    call keyway_set_blas_threads(int(omp_get_max_threads(), c_int))
    if (keyway_blas_uses_openmp() == 0) call omp_set_max_active_levels(0)
  end subroutine use_many_threads

  !> Restores one thread in the BLAS and the former levels of OpenMP.
  subroutine use_one_thread(levels)
    integer, intent(in) :: levels !< from `use_many_threads`
    call keyway_set_blas_threads(1_c_int)
    call omp_set_max_active_levels(levels)
  end subroutine use_one_thread
end module blas_threads
