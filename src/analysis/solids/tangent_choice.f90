!> Tangents of inelastic solids in a step, by *CONTROLS, TANGENT. AUTO follows measurements
!> (docs/studies/tangents_of_solids).
module tangent_choice
  use problem_definition, only: problem
  use step_plan, only: step
  use material_points, only: no_tangent, secant_tangent, consistent_tangent
  implicit none
  private
  public :: tangent, choose_tangents

  !> Kind of tangent and its use in the iteration.
  type :: tangent
    integer :: kind = no_tangent !< of the laws
    integer :: patience = huge(1) !< iterations before a matrix may be updated; 0: each
    logical :: holds_switches = .false. !< keeps the switches of the laws during the increment
  contains
    procedure :: is_symmetric
  end type tangent

  type(tangent), parameter :: consistent = tangent(consistent_tangent, 0)
  type(tangent), parameter :: secant = tangent(secant_tangent, 6)
  type(tangent), parameter :: elastic = tangent(no_tangent, huge(1))

contains

  !> Tangents of a step: the first, and one to try if the first does not converge. In measurements
  !> many iterations with the elastic matrix cost less than a few with new factors. They also do not
  !> follow unstable branches where a structure could crack in many places.
  pure function choose_tangents(model, plan) result(choices)
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    type(tangent), allocatable :: choices(:)
    choices = [elastic]
    if (.not. allocated(model%inelastic)) return
    if (size(model%inelastic) == 0) return
    select case (plan%controls%tangent)
    case ('CONSISTENT')
      choices = [consistent]
    case ('SECANT')
      choices = [secant]
    case ('ELASTIC')
      choices = [elastic]
    case default
      choices = [elastic, secant]
    end select
    if (.not. has_switches(model)) return
    if (size(choices) == 1) choices = [choices, choices(1)]
    choices(size(choices))%holds_switches = .true.
  end function choose_tangents

  !> Whether the stress of a law is discontinuous in strain, so that Newton may cycle. If no tangent
  !> converges the switches keep their values during the increment (theory.md, 12).
  pure logical function has_switches(model)
    type(problem), intent(in) :: model
    integer :: i
    has_switches = .false.
    do i = 1, size(model%inelastic)
      associate (law => model%materials(model%inelastic(i)%material)%law)
        has_switches = has_switches .or. law%has_switch
      end associate
    end do
  end function has_switches

  !> True unless the consistent tangent is used.
  elemental logical function is_symmetric(self)
    class(tangent), intent(in) :: self
    is_symmetric = self%kind /= consistent_tangent
  end function is_symmetric
end module tangent_choice
