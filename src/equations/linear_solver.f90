!> The contract of linear solvers. A distributed back end would extend this type.
module linear_solver
  use kinds, only: rk, long
  use errors, only: error_type, raise
  use factor_top, only: top_of_factor
  use matrix_pattern, only: pattern
  implicit none
  private
  public :: equation_solver, whole_factor, lower_part, upper_part

  type, abstract :: equation_solver
    integer :: failed_unknown = 0 !< unknown whose pivot failed, 0 for none
    !> Norm of the residual at which a solve by iteration may end; 0: at round-off of the forces [N]
    real(rk) :: admissible = 0.0_rk
    !> (free unknowns) order of elimination; not allocated: no forward and backward substitution
    integer, allocatable :: order(:)
  contains
    procedure(analyse), deferred :: analyse
    procedure(factorise), deferred :: factorise
    procedure(solve), deferred :: solve
    procedure :: solve_within, take_schur_block, take_top
    procedure :: forward_substitute => refuse_half_solve
    procedure :: backward_substitute => refuse_half_solve
    procedure :: choose_active => activate_all
    procedure :: substitute => refuse_part
    procedure :: keep_single => keep_double
    procedure :: copy_single => copy_nothing
    procedure :: num_entries => unknown_entries
    procedure :: describe_iterations => describe_none
    procedure :: has_patches => has_no_patches
    procedure :: take_patch => refuse_patch
    procedure :: solve_patch => refuse_solve_of_patch
    procedure :: drop_patch => keep_nothing
  end type equation_solver

  !> Parts of a factor. The upper part holds the columns of the active unknowns and all columns that
  !> depend on them; the lower part is the rest.
  integer, parameter :: whole_factor = 0, lower_part = 1, upper_part = 2

  abstract interface
    !> Orders the unknowns and plans the factor; once per pattern.
    subroutine analyse(self, matrix, error)
      import :: equation_solver, pattern, error_type
      implicit none
      class(equation_solver), intent(inout) :: self
      type(pattern), intent(in) :: matrix
      type(error_type), allocatable, intent(out) :: error
    end subroutine analyse

    !> Factors the free part of the matrix. Fails with `failed_unknown` if this part is singular or
    !> not positive definite.
    subroutine factorise(self, matrix, values, error)
      import :: equation_solver, pattern, error_type, rk
      implicit none
      class(equation_solver), intent(inout) :: self
      type(pattern), intent(in) :: matrix
      real(rk), intent(in) :: values(:)
      type(error_type), allocatable, intent(out) :: error
    end subroutine factorise

    !> Solves for each column of `b`, in place.
    subroutine solve(self, b, error)
      import :: equation_solver, error_type, rk
      implicit none
      class(equation_solver), intent(inout) :: self
      real(rk), intent(inout) :: b(:, :) !< (free unknowns, right-hand sides)
      type(error_type), allocatable, intent(out) :: error
    end subroutine solve
  end interface

contains

  !> Solves for each column of `b`, in place; an iteration may leave a residual.
  subroutine solve_within(self, admissible, b, error)
    class(equation_solver), intent(inout) :: self
    real(rk), intent(in) :: admissible !< norm of the residual; 0: round-off of the forces [N]
    real(rk), intent(inout) :: b(:, :) !< (free unknowns, right-hand sides)
    type(error_type), allocatable, intent(out) :: error
    self%admissible = admissible
    call self%solve(b, error)
    self%admissible = 0.0_rk
  end subroutine solve_within

  !> The Schur block: the dense end of a factor L L^T whose last columns are the last unknowns.
  !> `forward_substitute` gives y = L^-1 P b, `backward_substitute` x = P^T L^-T y. Not every
  !> solver has these three.
  subroutine take_schur_block(self, num_last, block, unknown, is_there)
    class(equation_solver), intent(in) :: self
    integer, intent(in) :: num_last !< unknowns at the end
    real(rk), allocatable, intent(out) :: block(:, :) !< (num_last, num_last) lower triangle
    integer, allocatable, intent(out) :: unknown(:) !< of each column of the block
    logical, intent(out) :: is_there
    allocate (block(0, 0), unknown(0))
    is_there = .false.
  end subroutine take_schur_block

  !> The top of a factor L L^T with some unknowns. Not every solver has it.
  subroutine take_top(self, unknown, top)
    class(equation_solver), intent(in) :: self
    integer, intent(in) :: unknown(:) !< that the top must hold
    type(top_of_factor), intent(out) :: top
    top%is_there = size(unknown) < 0
  end subroutine take_top

  !> Half of a solve, for solvers without forward and backward substitution.
  subroutine refuse_half_solve(self, b, error)
    class(equation_solver), intent(inout) :: self
    real(rk), intent(inout) :: b(:) !< (free unknowns)
    type(error_type), allocatable, intent(out) :: error
    call raise(error, 'this solver has no separate forward and backward substitution')
  end subroutine refuse_half_solve

  !> Chooses the active unknowns, for solvers whose factor has parts. `share` is that of the upper
  !> part in the entries of the factor, 1 without parts. Call it after `analyse`.
  subroutine activate_all(self, unknown, share)
    class(equation_solver), intent(inout) :: self
    integer, intent(in) :: unknown(:)
    real(rk), intent(out) :: share
    share = 1.0_rk
  end subroutine activate_all

  !> Keeps the factor in single precision until the next factorisation, but for its upper part with
  !> some unknowns; solves are then exact to some 7 digits. Not every solver can.
  subroutine keep_double(self, unknown, is_kept)
    class(equation_solver), intent(inout) :: self
    integer, intent(in) :: unknown(:) !< whose part stays in double precision
    logical, intent(out) :: is_kept
    is_kept = size(unknown) < 0
  end subroutine keep_double

  !> Keeps a copy of the factor in single precision until the next factorisation, for `substitute`.
  !> Not every solver can; none does without memory.
  subroutine copy_nothing(self, has_copy)
    class(equation_solver), intent(inout) :: self
    logical, intent(out) :: has_copy
    has_copy = self%failed_unknown > huge(1) - 1
  end subroutine copy_nothing

  !> Entries of the factor; 0 where the solver does not say.
  integer(long) function unknown_entries(self) result(entries)
    class(equation_solver), intent(in) :: self
    entries = 0_long
  end function unknown_entries

  !> Iterations of the solves so far and memory in words; '' for a solver that does not say.
  function describe_none(self) result(text)
    class(equation_solver), intent(in) :: self
    character(:), allocatable :: text
    text = repeat(' ', min(0, self%failed_unknown))
  end function describe_none

  !> Whether the compliance of joints comes from factors of parts of the matrix: solves are
  !> iterations, or the joints have too many unknowns for the end of the factor.
  logical function has_no_patches(self)
    class(equation_solver), intent(in) :: self
    has_no_patches = self%failed_unknown > huge(1) - 1
  end function has_no_patches

  !> Takes the patch of this rank: the unknowns within some layers of neighbours of the seeds. What
  !> is outside does not move. All ranks call it together. A rank keeps its patch where it gives no
  !> seeds, and where the new one would be too large: `unknown` is then empty.
  subroutine refuse_patch(self, matrix, values, seed, layers, most_rows, unknown, error)
    class(equation_solver), intent(inout) :: self
    type(pattern), intent(in) :: matrix !< as analysed
    real(rk), intent(in) :: values(:) !< as in the last factor
    integer, intent(in) :: seed(:) !< unknowns
    integer, intent(in) :: layers, most_rows
    integer, allocatable, intent(out) :: unknown(:) !< of each row of the patch, 0 for none
    type(error_type), allocatable, intent(out) :: error
    allocate (unknown(0))
    call raise(error, 'this solver has no factors of parts')
  end subroutine refuse_patch

  !> Solves for columns over the patch of this rank, in place. Other ranks take no part.
  subroutine refuse_solve_of_patch(self, b, error)
    class(equation_solver), intent(inout) :: self
    real(rk), intent(inout) :: b(:, :) !< (rows of the patch, right-hand sides)
    type(error_type), allocatable, intent(out) :: error
    call raise(error, 'this solver has no factors of parts')
  end subroutine refuse_solve_of_patch

  !> Gives the memory of the patch back, for solvers with patches.
  subroutine keep_nothing(self)
    class(equation_solver), intent(inout) :: self
  end subroutine keep_nothing

  !> y = L^-1 y or y = L^-T y with a part of the factor, in the order of elimination.
  subroutine refuse_part(self, in_single, part, is_forward, y, error)
    class(equation_solver), intent(inout) :: self
    logical, intent(in) :: in_single !< with the copy of `copy_single`
    integer, intent(in) :: part !< whole_factor, lower_part or upper_part
    logical, intent(in) :: is_forward
    real(rk), intent(inout) :: y(:) !< (free unknowns)
    type(error_type), allocatable, intent(out) :: error
    call raise(error, 'this solver has no separate forward and backward substitution')
  end subroutine refuse_part
end module linear_solver
