!> The calls of CHOLMOD behind plain arguments (cholmod_bridge.c, supernodes/single_factor.c).
module cholmod_calls
  use, intrinsic :: iso_c_binding, only: c_double, c_int, c_ptr
  implicit none
  private
  public :: keyway_cholmod_start, keyway_cholmod_finish, keyway_cholmod_analyse
  public :: keyway_cholmod_factorise, keyway_cholmod_solve, keyway_cholmod_end
  public :: keyway_cholmod_choose, keyway_cholmod_substitute, keyway_cholmod_round
  public :: keyway_cholmod_copy, keyway_cholmod_statistics, keyway_cholmod_order

  interface
    function keyway_cholmod_start() result(handle) bind(c)
      import :: c_ptr
      implicit none
      type(c_ptr) :: handle
    end function keyway_cholmod_start

    subroutine keyway_cholmod_finish(handle) bind(c)
      import :: c_ptr
      implicit none
      type(c_ptr), value :: handle
    end subroutine keyway_cholmod_finish

    function keyway_cholmod_analyse(handle, n, start, used, row, m, order) result(status) bind(c)
      import :: c_ptr, c_int
      implicit none
      type(c_ptr), value :: handle
      integer(c_int), value :: n, m
      integer(c_int), intent(in) :: start(n + 1), used(n), row(start(n + 1))
      type(c_ptr), value :: order
      integer(c_int) :: status
    end function keyway_cholmod_analyse

    function keyway_cholmod_factorise(handle, n, start, used, row, values, column, ratio) &
      result(status) bind(c)
      import :: c_ptr, c_int, c_double
      implicit none
      type(c_ptr), value :: handle
      integer(c_int), value :: n
      integer(c_int), intent(in) :: start(n + 1), used(n), row(start(n + 1))
      real(c_double), intent(in) :: values(start(n + 1))
      integer(c_int), intent(out) :: column
      real(c_double), intent(out) :: ratio
      integer(c_int) :: status
    end function keyway_cholmod_factorise

    function keyway_cholmod_solve(handle, n, columns, b) result(status) bind(c)
      import :: c_ptr, c_int, c_double
      implicit none
      type(c_ptr), value :: handle
      integer(c_int), value :: n, columns
      real(c_double), intent(inout) :: b(n, columns)
      integer(c_int) :: status
    end function keyway_cholmod_solve

    function keyway_cholmod_end(handle, n, m, block, unknown) result(status) bind(c)
      import :: c_ptr, c_int, c_double
      implicit none
      type(c_ptr), value :: handle
      integer(c_int), value :: n, m
      real(c_double), intent(out) :: block(m, m)
      integer(c_int), intent(out) :: unknown(m)
      integer(c_int) :: status
    end function keyway_cholmod_end

    function keyway_cholmod_choose(handle, n, count, unknown) result(share) bind(c)
      import :: c_ptr, c_int, c_double
      implicit none
      type(c_ptr), value :: handle
      integer(c_int), value :: n, count
      integer(c_int), intent(in) :: unknown(count)
      real(c_double) :: share
    end function keyway_cholmod_choose

    !> `in_single`: with the copy in single precision.
    function keyway_cholmod_substitute(handle, in_single, part, is_forward, n, y) result(status) &
      bind(c)
      import :: c_ptr, c_int, c_double
      implicit none
      type(c_ptr), value :: handle
      integer(c_int), value :: in_single, part, is_forward, n
      real(c_double), intent(inout) :: y(n)
      integer(c_int) :: status
    end function keyway_cholmod_substitute

    function keyway_cholmod_round(handle, n, count, unknown) result(status) bind(c)
      import :: c_ptr, c_int
      implicit none
      type(c_ptr), value :: handle
      integer(c_int), value :: n, count
      integer(c_int), intent(in) :: unknown(count)
      integer(c_int) :: status
    end function keyway_cholmod_round

    function keyway_cholmod_copy(handle) result(status) bind(c)
      import :: c_ptr, c_int
      implicit none
      type(c_ptr), value :: handle
      integer(c_int) :: status
    end function keyway_cholmod_copy

    subroutine keyway_cholmod_statistics(handle, entries, bytes, peak) bind(c)
      import :: c_ptr, c_double
      implicit none
      type(c_ptr), value :: handle
      real(c_double), intent(out) :: entries, bytes, peak
    end subroutine keyway_cholmod_statistics

    subroutine keyway_cholmod_order(handle, n, order) bind(c)
      import :: c_ptr, c_int
      implicit none
      type(c_ptr), value :: handle
      integer(c_int), value :: n
      integer(c_int), intent(out) :: order(n)
    end subroutine keyway_cholmod_order
  end interface
end module cholmod_calls
