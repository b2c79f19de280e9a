!> What every load can do. A load is a constant pattern; its factor in time belongs to the step.
!>
!> The defaults do nothing, so that a load overrides only what it brings into the model.
module applied_load
  use kinds, only: rk
  use dam_mesh, only: mesh
  implicit none
  private
  public :: load, load_slot

  type, abstract :: load
    character(:), allocatable :: name !< for the log and the list of effects
    character(:), allocatable :: kind !< 'gravity', 'pressure', 'reservoir', 'base motion', ...
    character(:), allocatable :: family !< its keyword, for OP=NEW: 'CLOAD', 'DLOAD', ...
    character(:), allocatable :: target !< identity for OP=MOD: same target, new magnitude
  contains
    procedure :: add_force
    procedure :: add_added_mass
    procedure :: add_base_acceleration
  end type load

  type :: load_slot
    class(load), allocatable :: item
  end type load_slot

contains

  !> Adds the nodal forces of the load at factor 1.
  subroutine add_force(self, model, density, force)
    class(load), intent(in) :: self
    type(mesh), intent(in) :: model
    real(rk), intent(in) :: density(:) !< (elements) [kg/m3]
    real(rk), intent(inout) :: force(:, :) !< (3, nodes) [N]
  end subroutine add_force

  !> Adds the mass of the water that moves with a node (3 x 3 blocks, nodes are not coupled).
  subroutine add_added_mass(self, model, blocks)
    class(load), intent(in) :: self
    type(mesh), intent(in) :: model
    real(rk), intent(inout) :: blocks(:, :, :) !< (3, 3, nodes) [kg]
  end subroutine add_added_mass

  !> Adds the acceleration of the base at factor 1; the inertia force is -M r of it.
  pure subroutine add_base_acceleration(self, acceleration)
    class(load), intent(in) :: self
    real(rk), intent(inout) :: acceleration(3) !< [m/s2]
  end subroutine add_base_acceleration
end module applied_load
