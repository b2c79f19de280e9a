!> The contract of material laws: stress from strain, for a block of points in one call.
module material_law
  use kinds, only: rk
  use material_points, only: point_set, point_state, time_increment, update_report, num_energies
  use thermal_expansion, only: expansion_table
  implicit none
  private
  public :: stress_law, material, start_points

  !> Stress from strain. Voigt order 11 22 33 12 13 23, engineering shear, tension positive.
  type, abstract :: stress_law
    integer :: num_state = 0 !< internal variables per point
    logical :: is_nonlinear = .false. !< false: stress = D strain, without history
    logical :: has_switch = .false. !< discontinuous stress: time_increment%holds_switches
    !> The stress is the derivative of the stored energy, which grows by the work less dissipation
    logical :: has_free_energy = .false.
    logical :: defers_energy = .false. !< updates without energies are faster
    logical :: is_serial = .false. !< one call at a time (user subroutines with saved data)
    logical :: wants_gradient = .false. !< of the displacement, besides the strain
    logical :: may_be_tried = .true. !< calls beside the analysis change nothing
  contains
    procedure(elastic_stiffness), deferred :: elastic_stiffness
    procedure(update), deferred :: update
    procedure :: set_start => start_from_zero
    procedure :: read_field => no_field
    procedure :: find_stiffness_factors => no_loss
  end type stress_law

  abstract interface
    !> The undamaged stiffness, constant in the material.
    pure subroutine elastic_stiffness(self, d)
      import :: stress_law, rk
      implicit none
      class(stress_law), intent(in) :: self
      real(rk), intent(out) :: d(6, 6) !< [Pa]
    end subroutine elastic_stiffness

    !> Stress and history at the end of an increment, for a block of points. The history starts from
    !> the converged one; earlier values of `new` do not count.
    subroutine update(self, points, time, old, new, tangent, report)
      import :: stress_law, rk, point_set, point_state, time_increment, update_report
      implicit none
      class(stress_law), intent(in) :: self
      type(point_set), intent(in) :: points
      type(time_increment), intent(in) :: time
      type(point_state), intent(in) :: old !< converged
      type(point_state), intent(inout) :: new !< allocated; strain (and gradient) are set
      real(rk), intent(inout) :: tangent(:, :, :) !< (6, 6, points) [Pa], or (6, 6, 0)
      type(update_report), intent(out) :: report
    end subroutine update
  end interface

  !> A material of the deck.
  type :: material
    character(:), allocatable :: name !< upper case
    real(rk) :: density = 0.0_rk !< [kg/m3]; 0: massless
    real(rk) :: young = 0.0_rk !< E of the undamaged material [Pa], for defaults of joints
    real(rk) :: poisson = 0.0_rk
    real(rk) :: alpha = 0.0_rk, beta = 0.0_rk !< Rayleigh damping [1/s], [s]
    logical :: damps_current = .false. !< beta acts on the damaged stiffness
    type(expansion_table), allocatable :: expansion !< thermal, where the material expands
    class(stress_law), allocatable :: law
    character(:), allocatable :: remark !< further text in the summary of the model, if any
  end type material

contains

  !> Allocates the state of a block at rest.
  subroutine start_points(law, points, state)
    class(stress_law), intent(in) :: law
    type(point_set), intent(in) :: points
    type(point_state), intent(out) :: state
    integer :: n
    n = points%num_points
    allocate (state%strain(6, n), state%stress(6, n), state%internal(law%num_state, n), &
              state%energy(num_energies, n), source=0.0_rk)
    allocate (state%gradient(3, 3, merge(n, 0, law%wants_gradient)), source=0.0_rk)
    allocate (state%is_elastic(n), source=.true.)
    call law%set_start(points, state)
  end subroutine start_points

  !> Default: the history starts with zeros.
  subroutine start_from_zero(self, points, state)
    class(stress_law), intent(in) :: self
    type(point_set), intent(in) :: points
    type(point_state), intent(inout) :: state
    if (self%num_state*points%num_points > 0) state%internal = 0.0_rk
  end subroutine start_from_zero

  !> A field of results at the points: 'PE' (plastic strain), 'DAMAGET', 'DAMAGEC', 'SDV' (all state
  !> variables). A law that has none gives no values.
  subroutine no_field(self, name, state, values)
    class(stress_law), intent(in) :: self
    character(*), intent(in) :: name
    type(point_state), intent(in) :: state
    real(rk), allocatable, intent(out) :: values(:, :) !< (components, points), or unallocated
    if (.not. self%is_nonlinear .and. name == 'PE') then
      allocate (values(6, size(state%strain, 2)), source=0.0_rk)
    end if
  end subroutine no_field

  !> Default: a law without damage keeps its stiffness.
  subroutine no_loss(self, state, factor)
    class(stress_law), intent(in) :: self
    type(point_state), intent(in) :: state
    real(rk), intent(out) :: factor(:) !< (points) stiffness over the undamaged one, 0..1
    factor = 1.0_rk
  end subroutine no_loss
end module material_law
