!> Equations whose matrix is a sum over ranks, by PETSc: factors of MUMPS or, for symmetric positive
!> definite matrices, conjugate gradients.
!>
!> A rank gives its rows of right-hand sides, and gets solutions in all unknowns that it holds.
module solver_petsc
  use, intrinsic :: iso_c_binding, only: c_associated, c_int, c_null_ptr, c_ptr, c_size_t
  use kinds, only: long, rk
  use entry_lists, only: list_block_values, list_blocks, list_entries, list_entry_values
  use errors, only: error_type, raise, system_failed
  use blas_threads, only: use_many_threads, use_one_thread
  use linear_solver, only: equation_solver
  use matrix_pattern, only: pattern
  use petsc_equations, only: by_cholesky, by_compressed, by_iteration, by_lu, drop_petsc_patch, &
                             entries_of_petsc, factor_petsc, finish_petsc, is_done, is_singular, &
                             is_slow, memory_of_petsc, plan_petsc, rows_of_petsc_patch, &
                             shift_of_petsc, solve_petsc, solve_petsc_patch, start_petsc, &
                             sum_petsc, take_petsc_patch
  use process_limits, only: free_memory
  use ranks, only: gather_rows, is_true_everywhere, num_ranks, num_ranks_here, share_error, &
                   this_rank
  use unknown_layout, only: choose_solver, compressed_solver, direct_solver, iterative_solver, &
                            num_rows, own_rows, row_layout
  use unknown_parts, only: unknown_part
  use write_text, only: as_text
  implicit none
  private
  public :: petsc_solver, method_text, settle_solver

  !> Most rows for which AUTO takes the factor.
  integer, parameter :: most_direct = 200000
  !> Memory of all ranks for the factor of an arch dam with rock [MB], and how it grows with the
  !> rows: MUMPS used 329 MB with 50 169 rows, 1475 MB with 149 760. A rank takes up to 1.2 times
  !> the mean, and room of 60 % (docs/large_models.md, 4).
  real(rk), parameter :: factor_memory = 1.2_rk*1.6_rk*1475.0_rk, its_rows = 149760.0_rk
  real(rk), parameter :: growth_of_memory = 1.37_rk

  type, extends(equation_solver) :: petsc_solver
    integer :: num_solves = 0 !< right-hand sides that were solved for
    integer :: num_iterations = 0, least = huge(1), most = 0 !< of all solves, of a solve
    type(c_ptr), private :: handle = c_null_ptr
    logical, private :: is_ready = .false. !< there is a factor
    logical, private :: has_failed = .false. !< PETSc has, on this rank or on all
    integer(c_int), private :: method = by_cholesky
    integer(c_size_t), private :: num_given = 0 !< entries (by_lu) or blocks that this rank adds
    type(row_layout), private :: layout !< its rows alone
    type(unknown_part), private :: part !< unknowns of this rank, where vectors are divided
  contains
    procedure :: analyse, factorise, solve
    procedure :: num_entries => num_entries_here
    procedure :: describe_iterations
    procedure :: has_patches, take_patch, solve_patch, drop_patch
    final :: release
  end type petsc_solver

contains

  !> Gives PETSc the places of the entries that this rank adds to the matrix.
  subroutine analyse(self, matrix, error)
    class(petsc_solver), intent(inout) :: self
    type(pattern), intent(in) :: matrix !< with a layout
    type(error_type), allocatable, intent(out) :: error
    integer(c_int), allocatable :: row(:), column(:)
    integer :: bounds(2)
    call release(self)
    self%layout%first_row = matrix%layout%first_row
    self%layout%row = matrix%layout%row
    self%part = matrix%part
    bounds = own_rows(self%layout, this_rank())
    self%method = by_lu
    if (matrix%is_symmetric) self%method = method_of(matrix%layout)
    if (self%method == by_lu) then
      call list_entries(matrix, row, column)
    else
      call list_blocks(matrix, row, column)
    end if
    self%num_given = size(row, kind=c_size_t)
    self%handle = start_petsc()
    if (.not. c_associated(self%handle)) then
      call raise(error, 'PETSc could not be started', system_failed)
    else if (plan_petsc(self%handle, self%method, int(bounds(2) - bounds(1) + 1, c_int), &
                        matrix%layout%rigid, self%num_given, row, column) /= is_done) then
      call raise(error, 'PETSc could not plan the equations (not enough memory?)', system_failed)
      self%has_failed = .true.
    end if
  end subroutine analyse

  !> Chooses between factor and iteration by size and memory, where that is left to the program. All
  !> ranks choose the same.
  subroutine settle_solver(layout)
    type(row_layout), intent(inout) :: layout
    if (layout%solver /= choose_solver) return
    layout%solver = iterative_solver
    if (num_rows(layout) > most_direct) return
    layout%lacks_memory = .not. is_true_everywhere(memory_of_factor(layout) <= &
                                                   free_memory(num_ranks_here()))
    if (.not. layout%lacks_memory) layout%solver = direct_solver
  end subroutine settle_solver

  !> Memory that a factor may need on a rank [MB].
  real(rk) function memory_of_factor(layout) result(megabytes)
    type(row_layout), intent(in) :: layout
    megabytes = factor_memory*(num_rows(layout)/its_rows)**growth_of_memory/num_ranks()
  end function memory_of_factor

  !> The method for a symmetric matrix.
  pure integer(c_int) function method_of(layout) result(method)
    type(row_layout), intent(in) :: layout !< with a settled solver
    method = by_iteration
    if (layout%solver == direct_solver) method = by_cholesky
    if (layout%solver == compressed_solver) method = by_compressed
  end function method_of

  !> The method for a symmetric matrix in words.
  function method_text(layout) result(text)
    type(row_layout), intent(in) :: layout
    character(:), allocatable :: text
    select case (method_of(layout))
    case (by_cholesky)
      text = 'factors by MUMPS'
    case (by_compressed)
      text = 'conjugate gradients with factors of low-rank blocks by MUMPS'
    case default
      text = 'conjugate gradients with an incomplete factor and the motions of groups of nodes'
    end select
    text = as_text(num_rows(layout))//' equations, '//text
    if (layout%lacks_memory .and. method_of(layout) == by_iteration) then
      text = text//' (a factor may need '//as_text(nint(memory_of_factor(layout)))// &
             ' MB on each rank; less is free)'
    end if
  end function method_text

  !> Sums the matrix over the ranks, and factors it or prepares the iteration.
  subroutine factorise(self, matrix, values, error)
    class(petsc_solver), intent(inout) :: self
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: values(:)
    type(error_type), allocatable, intent(out) :: error
    integer(c_int) :: status
    integer :: levels
    self%failed_unknown = 0
    if (num_rows(matrix%layout) == 0) return
    status = sum_values(self, matrix, values)
    call use_many_threads(levels)
    if (status == is_done) status = factor_petsc(self%handle)
    call use_one_thread(levels)
    if (status == is_singular) then
      call raise(error, 'the stiffness matrix is singular: a part of the model is free to '// &
                 'move; add supports, or connect the part by common nodes or a tie (a run '// &
                 'without mpiexec names the node)')
    else if (status /= is_done) then
      call raise(error, 'PETSc could not factor the matrix (not enough memory?)', system_failed)
      self%has_failed = .true.
    end if
    self%is_ready = status == is_done
  end subroutine factorise

  !> Gives PETSc the values of this rank.
  integer(c_int) function sum_values(self, matrix, values) result(status)
    type(petsc_solver), intent(in) :: self
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: values(:)
    real(rk), allocatable :: entries(:), blocks(:, :, :)
    if (self%method == by_lu) then
      allocate (entries(self%num_given))
      call list_entry_values(matrix, values, entries)
      status = sum_petsc(self%handle, entries)
    else
      allocate (blocks(3, 3, self%num_given))
      call list_block_values(matrix, values, blocks)
      status = sum_petsc(self%handle, blocks)
    end if
  end function sum_values

  !> Solves for each column of `b`, in place.
  subroutine solve(self, b, error)
    class(petsc_solver), intent(inout) :: self
    real(rk), intent(inout) :: b(:, :) !< (num_free, right-hand sides)
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: own(:, :)
    integer(c_int) :: status, iterations(size(b, 2))
    integer :: bounds(2), j, k
    if (num_rows(self%layout) == 0 .or. size(b, 2) == 0) return
    bounds = own_rows(self%layout, this_rank())
    allocate (own(bounds(2) - bounds(1) + 1, size(b, 2)), source=0.0_rk)
    do k = 1, size(b, 2)
      do j = 1, size(b, 1)
        associate (row => self%layout%row(j))
          if (row >= bounds(1) .and. row <= bounds(2)) own(row - bounds(1) + 1, k) = b(j, k)
        end associate
      end do
    end do
    status = solve_petsc(self%handle, int(size(own, 1), c_int), int(size(own, 2), c_int), &
                         self%admissible, own, iterations)
    self%num_solves = self%num_solves + size(iterations)
    self%num_iterations = self%num_iterations + int(sum(iterations))
    self%least = min(self%least, int(minval(iterations)))
    self%most = max(self%most, int(maxval(iterations)))
    self%has_failed = .not. any(status == [is_done, is_slow, is_singular])
    if (status /= is_done) call report_failure(status, maxval(iterations), error)
    if (self%has_failed) return
    do k = 1, size(b, 2)
      call spread_rows(self, own(:, k), b(:, k))
    end do
  end subroutine solve

  !> Gives the solution in the own rows to all ranks that hold its unknowns.
  subroutine spread_rows(self, own, x)
    class(petsc_solver), intent(in) :: self
    real(rk), contiguous, intent(in) :: own(:) !< (own rows)
    real(rk), contiguous, intent(out) :: x(:) !< (num_free)
    real(rk), allocatable :: all(:)
    integer :: bounds(2), j
    if (.not. self%part%is_divided) then
      allocate (all(num_rows(self%layout)))
      call gather_rows(self%layout%first_row, own, all)
      x = all(self%layout%row + 1)
      return
    end if
    bounds = own_rows(self%layout, this_rank())
    x = 0.0_rk
    do j = 1, size(x)
      associate (row => self%layout%row(j))
        if (row >= bounds(1) .and. row <= bounds(2)) x(j) = own(row - bounds(1) + 1)
      end associate
    end do
    call self%part%add(x)
  end subroutine spread_rows

  !> Mean, least and most iterations of a solve, and the memory of the factor.
  function describe_iterations(self) result(text)
    class(petsc_solver), intent(in) :: self
    character(:), allocatable :: text
    integer(c_int) :: memory(2)
    real(rk) :: shift
    text = ''
    if (self%num_solves == 0 .or. .not. self%is_ready) return
    if (self%method /= by_cholesky .and. self%method /= by_lu) then
      text = as_text(self%num_solves)//' solves took '// &
             as_text(nint(real(self%num_iterations, rk)/self%num_solves))//' iterations each ('// &
             as_text(self%least)//' to '//as_text(self%most)//')'
      shift = real(shift_of_petsc(self%handle), rk)
      if (shift > 0.0_rk) text = text//', incomplete factor of the matrix with '// &
                                 as_text(1.0_rk + shift)//' times its diagonal'
    end if
    call memory_of_petsc(self%handle, memory)
    if (memory(2) == 0) return
    if (text /= '') text = text//', '
    text = text//'MUMPS used '//as_text(int(memory(1)))//' MB on the largest rank, '// &
           as_text(int(memory(2)))//' MB in all'
  end function describe_iterations

  !> Entries of the factor on this rank.
  integer(long) function num_entries_here(self) result(entries)
    class(petsc_solver), intent(in) :: self
    entries = 0_long
    if (self%is_ready) entries = int(entries_of_petsc(self%handle), long)
  end function num_entries_here

  !> Whether solves are iterations, and there are equations.
  logical function has_patches(self)
    class(petsc_solver), intent(in) :: self
    has_patches = self%is_ready .and. self%method == by_iteration
  end function has_patches

  !> Takes the patch of this rank.
  subroutine take_patch(self, matrix, values, seed, layers, most_rows, unknown, error)
    class(petsc_solver), intent(inout) :: self
    type(pattern), intent(in) :: matrix !< as analysed
    real(rk), intent(in) :: values(:) !< as in the last factor: PETSc has them
    integer, intent(in) :: seed(:) !< unknowns
    integer, intent(in) :: layers, most_rows
    integer, allocatable, intent(out) :: unknown(:) !< of each row of the patch, 0 for none
    type(error_type), allocatable, intent(out) :: error
    integer(c_int), allocatable :: row(:)
    integer(c_int) :: num_found, status
    integer, allocatable :: unknown_of_row(:)
    integer :: j
    status = take_petsc_patch(self%handle, int(layers, c_int), int(most_rows, c_int), &
                              int(size(seed), c_int), int(self%layout%row(seed), c_int), num_found)
    allocate (row(num_found))
    if (status == is_done) status = rows_of_petsc_patch(self%handle, num_found, row)
    if (status /= is_done) then
      call raise(error, 'a part of the matrix near joints could not be factored (not enough '// &
                 'memory?)', system_failed)
    end if
    call share_error(error)
    if (allocated(error)) return
    allocate (unknown_of_row(num_rows(self%layout)), source=0)
    do j = 1, size(self%layout%row)
      unknown_of_row(self%layout%row(j) + 1) = j
    end do
    unknown = unknown_of_row(row + 1)
  end subroutine take_patch

  !> Solves for columns over the patch of this rank, in place.
  subroutine solve_patch(self, b, error)
    class(petsc_solver), intent(inout) :: self
    real(rk), intent(inout) :: b(:, :) !< (rows of the patch, right-hand sides)
    type(error_type), allocatable, intent(out) :: error
    if (solve_petsc_patch(self%handle, int(size(b, 1), c_int), int(size(b, 2), c_int), b) &
        == is_done) return
    call raise(error, 'PETSc failed to solve for a part of the matrix', system_failed)
  end subroutine solve_patch

  !> Gives the memory of the patch back.
  subroutine drop_patch(self)
    class(petsc_solver), intent(inout) :: self
    call drop_petsc_patch(self%handle)
  end subroutine drop_patch

  !> Why a solve has failed.
  subroutine report_failure(status, iterations, error)
    integer(c_int), intent(in) :: status, iterations
    type(error_type), allocatable, intent(out) :: error
    if (status == is_slow) then
      call raise(error, 'conjugate gradients did not converge in '//as_text(int(iterations))// &
                 ' iterations: a part of the model may be free to move; if none is, use '// &
                 '--solver DIRECT')
    else if (status == is_singular) then
      call raise(error, 'conjugate gradients failed, because the matrix is not positive '// &
                 'definite: a part of the model may be free to move; if none is, use '// &
                 '--solver DIRECT')
    else
      call raise(error, 'PETSc failed to solve the equations', system_failed)
    end if
  end subroutine report_failure

  !> Frees the memory of PETSc. All ranks do so together: after a failure, which may be that of one
  !> rank, nothing is freed, and the run ends.
  subroutine release(self)
    type(petsc_solver), intent(inout) :: self
    if (.not. self%has_failed) call finish_petsc(self%handle)
    self%handle = c_null_ptr
    self%is_ready = .false.
  end subroutine release
end module solver_petsc
