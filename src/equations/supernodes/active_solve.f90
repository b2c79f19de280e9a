!> Solves of one matrix with right-hand sides that differ in the active unknowns alone, where the
!> solution is needed at the active unknowns alone until the last of them.
!>
!> The lower part of the factor is used twice: forwards for the first right-hand side, backwards to
!> complete the last solution. All solves between need the upper part only.
module active_solve
  use errors, only: error_type
  use kinds, only: rk
  use linear_solver, only: equation_solver, lower_part, upper_part
  implicit none
  private
  public :: repeated_solve

  type :: repeated_solve
    integer, allocatable, private :: active(:) !< unknowns
    real(rk), allocatable, private :: first_rhs(:) !< (free unknowns)
    real(rk), allocatable, private :: reduced(:) !< (free unknowns) first_rhs after the lower part
    real(rk), allocatable, private :: half(:) !< (free unknowns) of the last solution
    real(rk), allocatable, private :: others(:) !< (free unknowns) of an incomplete solution
    logical, private :: is_partial = .false. !< the last solution holds active unknowns alone
  contains
    procedure :: choose => choose_repeated
    procedure :: is_there, start => start_repeated
    procedure :: forward, backward, complete
  end type repeated_solve

  !> Largest share of the upper part for which solves with it are worth their vectors.
  real(rk), parameter :: largest_share = 0.9_rk

contains

  !> Chooses the active unknowns of a factor that is planned. Where its upper part is nearly the
  !> whole, or where it has no parts, none are chosen: solves are then whole ones.
  subroutine choose_repeated(self, factor, active, others)
    class(repeated_solve), intent(inout) :: self
    class(equation_solver), intent(inout) :: factor
    integer, intent(in) :: active(:)
    real(rk), intent(in) :: others(:) !< (free unknowns) what solutions have until they are complete
    real(rk) :: share
    self%is_partial = .false.
    if (allocated(self%active)) deallocate (self%active)
    if (.not. allocated(factor%order) .or. size(active) == 0) return
    call factor%choose_active(active, share)
    if (share >= largest_share) return
    self%active = active
    self%others = others
  end subroutine choose_repeated

  !> Whether solves can be repeated with a factor.
  pure logical function is_there(self, factor)
    class(repeated_solve), intent(in) :: self
    class(equation_solver), intent(in) :: factor
    is_there = allocated(self%active) .and. allocated(factor%order)
  end function is_there

  !> The first right-hand side.
  subroutine start_repeated(self, factor, rhs, error)
    class(repeated_solve), intent(inout) :: self
    class(equation_solver), intent(inout) :: factor
    real(rk), intent(in) :: rhs(:) !< (free unknowns)
    type(error_type), allocatable, intent(out) :: error
    self%first_rhs = rhs
    self%reduced = rhs(factor%order)
    call factor%substitute(lower_part, .true., self%reduced, error)
  end subroutine start_repeated

  !> Replaces a right-hand side by its forward substitution, in the order of elimination.
  subroutine forward(self, factor, b, error)
    class(repeated_solve), intent(inout) :: self
    class(equation_solver), intent(inout) :: factor
    real(rk), intent(inout) :: b(:) !< (free unknowns) differs from the first in active ones
    type(error_type), allocatable, intent(out) :: error
    b = b - self%first_rhs
    b = self%reduced + b(factor%order)
    call factor%substitute(upper_part, .true., b, error)
  end subroutine forward

  !> Backward substitution; with `is_partial` for the active unknowns alone, the others stay.
  subroutine backward(self, factor, half, is_partial, x, error)
    class(repeated_solve), intent(inout) :: self
    class(equation_solver), intent(inout) :: factor
    real(rk), intent(in) :: half(:) !< (free unknowns) in the order of elimination
    logical, intent(in) :: is_partial
    real(rk), intent(out) :: x(:) !< (free unknowns)
    type(error_type), allocatable, intent(out) :: error
    real(rk) :: answer(size(half))
    self%half = half
    self%is_partial = .true.
    call factor%substitute(upper_part, .false., self%half, error)
    if (is_partial) then
      answer(factor%order) = self%half
      x = self%others
      x(self%active) = answer(self%active)
    else
      call self%complete(factor, x, error)
    end if
  end subroutine backward

  !> All unknowns of the last solution.
  subroutine complete(self, factor, x, error)
    class(repeated_solve), intent(inout) :: self
    class(equation_solver), intent(inout) :: factor
    real(rk), intent(inout) :: x(:) !< (free unknowns)
    type(error_type), allocatable, intent(out) :: error
    if (.not. self%is_partial) return
    call factor%substitute(lower_part, .false., self%half, error)
    x(factor%order) = self%half
    self%others = x
    self%is_partial = .false.
  end subroutine complete
end module active_solve
