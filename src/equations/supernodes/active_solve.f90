!> Solves of one matrix with right-hand sides that differ in the active unknowns alone, where the
!> solution is needed at the active unknowns alone until the last of them.
!>
!> The lower part of the factor is used twice: forwards for the first right-hand side, backwards to
!> complete the last solution. All solves between need the upper part only. Without active unknowns
!> all solves are whole ones.
!>
!> Where the factor has a copy in single precision, solves are those of the difference from the last
!> solution before them (last_solution).
module active_solve
  use errors, only: error_type
  use kinds, only: rk
  use last_solution, only: known_solution
  use linear_solver, only: equation_solver, lower_part, upper_part, whole_factor
  implicit none
  private
  public :: repeated_solve

  type :: repeated_solve
    integer, allocatable, private :: active(:) !< unknowns; not allocated: all of them
    real(rk), allocatable, private :: first_rhs(:) !< (free unknowns)
    real(rk), allocatable, private :: reduced(:) !< (free unknowns) first_rhs after the lower part
    real(rk), allocatable, private :: half(:) !< (free unknowns) of the last solution
    real(rk), allocatable, private :: others(:) !< (free unknowns) of an incomplete solution
    logical, private :: is_partial = .false. !< the last solution holds active unknowns alone
    type(known_solution), private :: known !< from which solutions differ
  contains
    procedure :: choose => choose_repeated
    procedure :: open => open_repeated, is_there, start => start_repeated
    procedure :: forward, backward, complete, leave => leave_solution
    procedure :: describe => describe_solutions
    procedure, private :: part_of_change
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

  !> Takes a factor that is new.
  subroutine open_repeated(self, factor, has_copy, diagonal)
    class(repeated_solve), intent(inout) :: self
    class(equation_solver), intent(in) :: factor
    logical, intent(in) :: has_copy !< in single precision, of the factor
    real(rk), intent(in) :: diagonal(:) !< (free unknowns) of the matrix
    call self%known%open(has_copy)
    if (has_copy) self%known%diagonal = diagonal(factor%order)
  end subroutine open_repeated

  !> The next solution is far from the last one.
  subroutine leave_solution(self)
    class(repeated_solve), intent(inout) :: self
    call self%known%leave()
  end subroutine leave_solution

  !> How many solutions were those of differences; '' where none can be.
  function describe_solutions(self) result(text)
    class(repeated_solve), intent(in) :: self
    character(:), allocatable :: text
    text = self%known%describe()
  end function describe_solutions

  !> Whether solves can be repeated with a factor.
  pure logical function is_there(self, factor)
    class(repeated_solve), intent(in) :: self
    class(equation_solver), intent(in) :: factor
    is_there = (allocated(self%active) .or. self%known%has_copy) .and. allocated(factor%order)
  end function is_there

  !> Part of the factor with which right-hand sides and solutions change.
  pure integer function part_of_change(self)
    class(repeated_solve), intent(in) :: self
    part_of_change = merge(upper_part, whole_factor, allocated(self%active))
  end function part_of_change

  !> The first right-hand side.
  subroutine start_repeated(self, factor, admissible, rhs, error)
    class(repeated_solve), intent(inout) :: self
    class(equation_solver), intent(inout) :: factor
    real(rk), intent(in) :: admissible !< norm of the residual of a solution [N]
    real(rk), intent(in) :: rhs(:) !< (free unknowns)
    type(error_type), allocatable, intent(out) :: error
    call self%known%start(admissible)
    self%first_rhs = rhs
    self%reduced = rhs(factor%order)
    if (self%known%is_used) self%reduced = self%reduced - self%known%b
    if (allocated(self%active)) then
      call factor%substitute(self%known%is_used, lower_part, .true., self%reduced, error)
    end if
  end subroutine start_repeated

  !> Replaces a right-hand side by its forward substitution, in the order of elimination.
  subroutine forward(self, factor, b, error)
    class(repeated_solve), intent(inout) :: self
    class(equation_solver), intent(inout) :: factor
    real(rk), intent(inout) :: b(:) !< (free unknowns) differs from the first in active ones
    type(error_type), allocatable, intent(out) :: error
    real(rk) :: y(size(b))
    y = b - self%first_rhs
    y = self%reduced + y(factor%order)
    call factor%substitute(self%known%is_used, self%part_of_change(), .true., y, error)
    if (self%known%is_used) y = y + self%known%y
    if (self%known%has_copy) call self%known%take_forward(b(factor%order), y)
    b = y
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
    call self%known%take_half(half)
    if (self%known%is_used) self%half = self%half - self%known%half
    self%is_partial = .true.
    call factor%substitute(self%known%is_used, self%part_of_change(), .false., self%half, error)
    if (is_partial .and. allocated(self%active)) then
      answer = self%half
      if (self%known%is_used) answer = answer + self%known%x
      answer(factor%order) = answer
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
    if (allocated(self%active)) then
      call factor%substitute(self%known%is_used, lower_part, .false., self%half, error)
    end if
    if (self%known%is_used) self%half = self%half + self%known%x
    call self%known%keep(self%half)
    x(factor%order) = self%half
    self%others = x
    self%is_partial = .false.
  end subroutine complete
end module active_solve
