!> A law for tests of results: nonlinear by name, its histories are set by hand.
module hand_law
  use kinds, only: rk
  use material_law, only: stress_law
  use material_elastic, only: elastic_law
  use material_points, only: point_set, point_state, time_increment, update_report
  use problem_definition, only: problem
  use analysis_state, only: state
  implicit none
  private
  public :: by_hand, set_elastic

  !> Internal variables: damage in tension, damage in compression, plastic strain (6).
  type, extends(stress_law) :: by_hand
    real(rk) :: young = 20.0e9_rk, poisson = 0.2_rk
  contains
    procedure :: elastic_stiffness
    procedure :: update
    procedure :: read_field
  end type by_hand

contains

  !> Hooke's law.
  pure subroutine elastic_stiffness(self, d)
    class(by_hand), intent(in) :: self
    real(rk), intent(out) :: d(6, 6)
    type(elastic_law) :: bulk
    bulk%young = self%young
    bulk%poisson = self%poisson
    call bulk%elastic_stiffness(d)
  end subroutine elastic_stiffness

  !> Elastic; the history is carried over.
  subroutine update(self, points, time, old, new, tangent, report)
    class(by_hand), intent(in) :: self
    type(point_set), intent(in) :: points
    type(time_increment), intent(in) :: time
    type(point_state), intent(in) :: old
    type(point_state), intent(inout) :: new
    real(rk), intent(inout) :: tangent(:, :, :)
    type(update_report), intent(out) :: report
    type(elastic_law) :: bulk
    bulk%young = self%young
    bulk%poisson = self%poisson
    call bulk%update(points, time, old, new, tangent, report)
  end subroutine update

  !> PE, DAMAGET, DAMAGEC and SDV.
  subroutine read_field(self, name, state, values)
    class(by_hand), intent(in) :: self
    character(*), intent(in) :: name
    type(point_state), intent(in) :: state
    real(rk), allocatable, intent(out) :: values(:, :)
    select case (name)
    case ('DAMAGET')
      values = state%internal(1:1, :)
    case ('DAMAGEC')
      values = state%internal(2:2, :)
    case ('PE')
      values = state%internal(3:8, :)
    case ('SDV')
      values = state%internal(:self%num_state, :)
    case default
      if (allocated(values)) deallocate (values)
    end select
  end subroutine read_field

  !> Strain of the displacements and elastic stress at all points.
  subroutine set_elastic(model, now)
    type(problem), intent(in) :: model
    type(state), intent(inout) :: now !< with displacements and points at rest
    real(rk) :: d(6, 6), b(6, 24), moved(24)
    integer :: i, e, q, p
    do i = 1, size(model%inelastic)
      associate (part => model%inelastic(i))
        call model%materials(part%material)%law%elastic_stiffness(d)
        do e = 1, size(part%elements)
          moved = reshape(now%u(:, model%mesh%nodes(:, part%elements(e))), [24])
          do q = 1, part%points_of_element
            p = (e - 1)*part%points_of_element + q
            call part%find_operator(e, q, b)
            now%points(i)%strain(:, p) = matmul(b, moved)
            now%points(i)%stress(:, p) = matmul(d, now%points(i)%strain(:, p))
          end do
        end do
      end associate
    end do
  end subroutine set_elastic
end module hand_law
