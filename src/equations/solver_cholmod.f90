!> Symmetric positive definite equations by CHOLMOD: supernodal L L^T, METIS, the unknowns of
!> joints last.
module solver_cholmod
  use, intrinsic :: iso_c_binding, only: c_associated, c_int, c_loc, c_null_ptr, c_ptr
  use cholmod_calls, only: keyway_cholmod_start, keyway_cholmod_finish, keyway_cholmod_analyse, &
                           keyway_cholmod_factorise, keyway_cholmod_solve, keyway_cholmod_end, &
                           keyway_cholmod_choose, keyway_cholmod_substitute, &
                           keyway_cholmod_round, keyway_cholmod_copy, keyway_cholmod_statistics, &
                           keyway_cholmod_order
  use cholmod_status, only: plan_failure
  use kinds, only: rk, long
  use errors, only: error_type, raise, system_failed
  use factor_top, only: choose_top, top_of_factor
  use matrix_parts, only: grow_part, list_neighbours, neighbour_lists, take_part
  use matrix_pattern, only: pattern
  use linear_solver, only: equation_solver, whole_factor
  use nested_dissection, only: dissect
  use wider_pattern, only: widen_pattern
  use blas_threads, only: use_many_threads, use_one_thread
  implicit none
  private
  public :: cholmod_solver

  integer, parameter :: most_columns = 32 !< solved at once, which bounds the workspace

  !> A pivot below this fraction of its diagonal entry is roundoff: the matrix is singular.
  real(rk), parameter :: smallest_ratio = 1.0e-14_rk

  type, extends(equation_solver) :: cholmod_solver
    logical :: uses_own_order = .false. !< the order is CHOLMOD's, jumps anywhere
    type(c_ptr), private :: handle = c_null_ptr
    integer, private :: num_free = 0
    integer(c_int), allocatable, private :: start(:), row(:) !< pattern, 0-based
    logical, private :: orders_freely = .false. !< the unknowns of joints
    type(neighbour_lists), allocatable, private :: neighbours !< while parts are factored
    class(equation_solver), allocatable, private :: part !< of the matrix
  contains
    procedure :: analyse, factorise, solve, statistics
    procedure :: take_schur_block, take_top, forward_substitute, backward_substitute
    procedure :: choose_active, substitute, keep_single, copy_single, num_entries
    procedure :: has_patches, take_patch, solve_patch, drop_patch
    final :: release
  end type cholmod_solver

contains

  !> Orders the free unknowns and plans the factor.
  subroutine analyse(self, matrix, error)
    class(cholmod_solver), intent(inout) :: self
    type(pattern), intent(in) :: matrix !< symmetric
    type(error_type), allocatable, intent(out) :: error
    integer(c_int), allocatable, target :: order(:)
    integer :: status
    if (.not. c_associated(self%handle)) self%handle = keyway_cholmod_start()
    if (.not. c_associated(self%handle)) then
      call raise(error, 'no memory for the equation solver', system_failed)
      return
    end if
    self%num_free = matrix%num_free
    self%orders_freely = matrix%orders_freely
    if (self%num_free == 0) return
    call shift_pattern(matrix, self%start, self%row)
    if (self%uses_own_order) then
      status = keyway_cholmod_analyse(self%handle, self%num_free, self%start, matrix%free_entries, &
                                      self%row, 0, c_null_ptr)
    else
      call dissect(matrix, order, error)
      if (allocated(error)) return
      order(:) = order - 1
      if (allocated(matrix%group)) then
        status = analyse_in_groups(self, matrix, order)
      else
        status = keyway_cholmod_analyse(self%handle, self%num_free, self%start, &
                                        matrix%free_entries, self%row, matrix%num_last, &
                                        c_loc(order))
      end if
    end if
    if (status /= 0) then
      call raise(error, plan_failure(status), system_failed)
      return
    end if
    if (allocated(self%order)) deallocate (self%order)
    allocate (self%order(self%num_free))
    call keyway_cholmod_order(self%handle, self%num_free, self%order)
    self%order = self%order + 1
  end subroutine analyse

  !> Plans the factor of a pattern in which jumps have the couplings of both sides of their joints.
  integer function analyse_in_groups(self, matrix, order) result(status)
    class(cholmod_solver), intent(inout) :: self
    type(pattern), intent(in) :: matrix
    integer(c_int), intent(inout), target :: order(:) !< of elimination, 0-based
    integer(c_int), allocatable :: start(:), used(:), row(:)
    associate (n => self%num_free)
      call widen_pattern(matrix%column_start(:n + 1), matrix%free_entries(:n), matrix%row, &
                         matrix%joined, matrix%jump, start, row)
    end associate
    used = start(2:) - start(:self%num_free)
    start = start - 1
    row = row - 1
    status = keyway_cholmod_analyse(self%handle, self%num_free, start, used, row, 0, c_loc(order))
  end function analyse_in_groups

  !> Columns and rows of the free part, counted from 0 as CHOLMOD does.
  pure subroutine shift_pattern(matrix, start, row)
    type(pattern), intent(in) :: matrix
    integer(c_int), allocatable, intent(out) :: start(:), row(:)
    integer :: num_entries
    num_entries = matrix%column_start(matrix%num_free + 1) - 1
    allocate (start(matrix%num_free + 1), row(num_entries))
    start(:) = matrix%column_start(:matrix%num_free + 1) - 1
    row(:) = matrix%row(:num_entries) - 1
  end subroutine shift_pattern

  !> Factors the free part. A matrix that is not positive definite, or singular up to roundoff, is
  !> an error; `failed_unknown` is the unknown.
  subroutine factorise(self, matrix, values, error)
    class(cholmod_solver), intent(inout) :: self
    type(pattern), intent(in) :: matrix !< as analysed
    real(rk), intent(in) :: values(:)
    type(error_type), allocatable, intent(out) :: error
    integer(c_int) :: status, column
    integer :: levels
    real(rk) :: ratio
    self%failed_unknown = 0
    if (self%num_free == 0) return
    call use_many_threads(levels)
    status = keyway_cholmod_factorise(self%handle, self%num_free, self%start, matrix%free_entries, &
                                      self%row, values, column, ratio)
    call use_one_thread(levels)
    if (status == 1 .or. (status == 0 .and. .not. ratio > smallest_ratio)) then
      self%failed_unknown = column + 1
      call raise(error, 'the stiffness is singular or not positive definite')
    else if (status == -2) then
      call raise(error, 'no memory for the factor of the stiffness', system_failed)
    else if (status /= 0) then
      call raise(error, 'CHOLMOD failed to factor the stiffness', system_failed)
    end if
  end subroutine factorise

  !> Solves for each column of `b`, in place.
  subroutine solve(self, b, error)
    class(cholmod_solver), intent(inout) :: self
    real(rk), intent(inout) :: b(:, :) !< (num_free, right-hand sides)
    type(error_type), allocatable, intent(out) :: error
    integer :: first, last, num_columns, levels
    integer(c_int) :: status
    if (self%num_free == 0) return
    num_columns = size(b, 2)
    if (num_columns > 1) call use_many_threads(levels)
    status = 0
    do first = 1, num_columns, most_columns
      last = min(first + most_columns - 1, num_columns)
      status = keyway_cholmod_solve(self%handle, self%num_free, last - first + 1, b(:, first:last))
      if (status /= 0) exit
    end do
    if (num_columns > 1) call use_one_thread(levels)
    if (status /= 0) call raise(error, 'no memory to solve the equations', system_failed)
  end subroutine solve

  !> The dense end of the factor, if its last columns are the last unknowns.
  subroutine take_schur_block(self, num_last, block, unknown, is_there)
    class(cholmod_solver), intent(in) :: self
    integer, intent(in) :: num_last
    real(rk), allocatable, intent(out) :: block(:, :)
    integer, allocatable, intent(out) :: unknown(:)
    logical, intent(out) :: is_there
    allocate (block(num_last, num_last), unknown(num_last))
    is_there = num_last > 0 .and. num_last <= self%num_free
    if (is_there) is_there = keyway_cholmod_end(self%handle, self%num_free, num_last, block, &
                                                unknown) == 0
    unknown(:) = unknown + 1
  end subroutine take_schur_block

  !> Chooses the active unknowns; `share` is that of their part of the factor.
  subroutine choose_active(self, unknown, share)
    class(cholmod_solver), intent(inout) :: self
    integer, intent(in) :: unknown(:)
    real(rk), intent(out) :: share
    share = keyway_cholmod_choose(self%handle, self%num_free, size(unknown), unknown - 1)
    if (share < 0.0_rk) share = 1.0_rk
  end subroutine choose_active

  !> Keeps the factor in single precision, but for the upper part with some unknowns.
  subroutine keep_single(self, unknown, is_kept)
    class(cholmod_solver), intent(inout) :: self
    integer, intent(in) :: unknown(:)
    logical, intent(out) :: is_kept
    is_kept = self%num_free > 0
    if (is_kept) is_kept = keyway_cholmod_round(self%handle, self%num_free, size(unknown), &
                                                unknown - 1) == 0
  end subroutine keep_single

  !> The top of the factor with some unknowns.
  subroutine take_top(self, unknown, top)
    class(cholmod_solver), intent(in) :: self
    integer, intent(in) :: unknown(:)
    type(top_of_factor), intent(out) :: top
    call choose_top(self%handle, self%num_free, unknown, top)
  end subroutine take_top

  !> Keeps a copy of the factor in single precision.
  subroutine copy_single(self, has_copy)
    class(cholmod_solver), intent(inout) :: self
    logical, intent(out) :: has_copy
    has_copy = self%num_free > 0
    if (has_copy) has_copy = keyway_cholmod_copy(self%handle) == 0
  end subroutine copy_single

  !> Replaces b by L^-1 P b, in the order of elimination.
  subroutine forward_substitute(self, b, error)
    class(cholmod_solver), intent(inout) :: self
    real(rk), intent(inout) :: b(:)
    type(error_type), allocatable, intent(out) :: error
    b = b(self%order)
    call self%substitute(.false., whole_factor, .true., b, error)
  end subroutine forward_substitute

  !> Replaces y by P^T L^-T y, in the order of the unknowns.
  subroutine backward_substitute(self, b, error)
    class(cholmod_solver), intent(inout) :: self
    real(rk), intent(inout) :: b(:)
    type(error_type), allocatable, intent(out) :: error
    call self%substitute(.false., whole_factor, .false., b, error)
    b(self%order) = b
  end subroutine backward_substitute

  !> y = L^-1 y or L^-T y on a part of the factor, in the order of elimination.
  subroutine substitute(self, in_single, part, is_forward, y, error)
    class(cholmod_solver), intent(inout) :: self
    logical, intent(in) :: in_single
    integer, intent(in) :: part
    logical, intent(in) :: is_forward
    real(rk), intent(inout) :: y(:)
    type(error_type), allocatable, intent(out) :: error
    if (self%num_free == 0) return
    if (keyway_cholmod_substitute(self%handle, merge(1, 0, in_single), part, &
                                  merge(1, 0, is_forward), size(y), y) /= 0) then
      call raise(error, 'no memory to solve the equations', system_failed)
    end if
  end subroutine substitute

  !> Whether the compliance of joints comes from factors of parts of the matrix.
  logical function has_patches(self)
    class(cholmod_solver), intent(in) :: self
    has_patches = self%orders_freely .and. self%num_free > 0
  end function has_patches

  !> Factors the part of the matrix near the seeds.
  subroutine take_patch(self, matrix, values, seed, layers, most_rows, unknown, error)
    class(cholmod_solver), intent(inout) :: self
    type(pattern), intent(in) :: matrix !< as analysed
    real(rk), intent(in) :: values(:)
    integer, intent(in) :: seed(:) !< unknowns
    integer, intent(in) :: layers, most_rows
    integer, allocatable, intent(out) :: unknown(:) !< of each row of the patch
    type(error_type), allocatable, intent(out) :: error
    type(pattern) :: part
    real(rk), allocatable :: part_values(:)
    if (.not. allocated(self%neighbours)) then
      allocate (self%neighbours)
      call list_neighbours(matrix, self%neighbours)
    end if
    call grow_part(self%neighbours, seed, layers, unknown)
    if (size(unknown) > most_rows) unknown = [integer ::]
    if (size(unknown) == 0) return
    call take_part(matrix, values, unknown, part, part_values)
    if (allocated(self%part)) deallocate (self%part)
    allocate (cholmod_solver :: self%part)
    call self%part%analyse(part, error)
    if (.not. allocated(error)) call self%part%factorise(part, part_values, error)
  end subroutine take_patch

  !> Solves for columns over the part, in place.
  subroutine solve_patch(self, b, error)
    class(cholmod_solver), intent(inout) :: self
    real(rk), intent(inout) :: b(:, :) !< (rows of the patch, right-hand sides)
    type(error_type), allocatable, intent(out) :: error
    call self%part%solve(b, error)
  end subroutine solve_patch

  !> Gives the memory of the part back.
  subroutine drop_patch(self)
    class(cholmod_solver), intent(inout) :: self
    if (allocated(self%part)) deallocate (self%part)
    if (allocated(self%neighbours)) deallocate (self%neighbours)
  end subroutine drop_patch

  !> Size and memory of the factor.
  subroutine statistics(self, entries, bytes, peak_bytes)
    class(cholmod_solver), intent(in) :: self
    real(rk), intent(out) :: entries !< of L
    real(rk), intent(out) :: bytes, peak_bytes !< held now, and at most so far
    entries = 0.0_rk
    bytes = 0.0_rk
    peak_bytes = 0.0_rk
    if (c_associated(self%handle)) call keyway_cholmod_statistics(self%handle, entries, bytes, &
                                                                  peak_bytes)
  end subroutine statistics

  !> Entries of the factor.
  integer(long) function num_entries(self)
    class(cholmod_solver), intent(in) :: self
    real(rk) :: entries, bytes, peak_bytes
    call self%statistics(entries, bytes, peak_bytes)
    num_entries = int(entries, long)
  end function num_entries

  !> Frees the memory of CHOLMOD.
  subroutine release(self)
    type(cholmod_solver), intent(inout) :: self
    call keyway_cholmod_finish(self%handle)
    self%handle = c_null_ptr
  end subroutine release
end module solver_cholmod
