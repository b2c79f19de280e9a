!> The contract of guests: the effects that a deck brings into a model, such as a reservoir, springs
!> between meshes, a joint or a load.
!>
!> The defaults do nothing, so that a guest overrides only what it has. A step calls every guest
!> that takes part in it, in the order of guest_list; no other code checks whether a guest is
!> present. Arrays that no guest needs are not allocated.
module guest_type
  use kinds, only: rk
  use dam_mesh, only: fe_mesh
  use dof_numbering, only: numbering
  use matrix_pattern, only: pattern
  use row_tables, only: row_table
  implicit none
  private
  public :: guest, guest_slot, guest_reference
  public :: stiffness_matrix, damping_matrix, mass_matrix

  !> The constant matrices of a step.
  integer, parameter :: stiffness_matrix = 1 !< K [N/m]
  integer, parameter :: damping_matrix = 2 !< C [N s/m]
  integer, parameter :: mass_matrix = 3 !< M [kg]

  type, abstract :: guest
    character(:), allocatable :: name !< for the log, the ledger and the list of effects
    character(:), allocatable :: kind !< 'gravity', 'reservoir', 'coupling', ..
  contains
    procedure :: add_cells
    procedure :: has_matrix
    procedure :: add_matrix
    procedure :: has_force
    procedure :: add_force
    procedure :: add_base_acceleration
    procedure :: add_supports
    procedure :: describe
  end type guest

  !> A guest in a list.
  type :: guest_slot
    class(guest), allocatable :: item
  end type guest_slot

  !> A guest that another list owns.
  type :: guest_reference
    class(guest), pointer :: item => null()
  end type guest_reference

contains

  !> Appends the cells of the guest: lists of nodes that its matrices couple with each other.
  subroutine add_cells(self, cells)
    class(guest), intent(in) :: self
    type(row_table), intent(inout) :: cells !< positions of nodes in the mesh
  end subroutine add_cells

  !> Whether the guest adds to a matrix of the step.
  pure logical function has_matrix(self, kind)
    class(guest), intent(in) :: self
    integer, intent(in) :: kind !< stiffness_matrix, damping_matrix or mass_matrix
    has_matrix = .false.
  end function has_matrix

  !> Adds the guest's constant matrix of a kind, T^T k T (scatter_matrix).
  subroutine add_matrix(self, kind, mesh, numbers, matrix, values)
    class(guest), intent(in) :: self
    integer, intent(in) :: kind !< stiffness_matrix, damping_matrix or mass_matrix
    type(fe_mesh), intent(in) :: mesh
    type(numbering), intent(in) :: numbers
    type(pattern), intent(in) :: matrix
    real(rk), intent(inout) :: values(:) !< of the pattern
  end subroutine add_matrix

  !> Whether a guest that is not a load has forces; they act in every step at factor 1.
  pure logical function has_force(self)
    class(guest), intent(in) :: self
    has_force = .false.
  end function has_force

  !> Adds the nodal forces of the guest at factor 1.
  subroutine add_force(self, mesh, density, force)
    class(guest), intent(in) :: self
    type(fe_mesh), intent(in) :: mesh
    real(rk), intent(in) :: density(:) !< (elements) [kg/m3]
    real(rk), intent(inout) :: force(:, :) !< (3, nodes) [N]
  end subroutine add_force

  !> Adds the acceleration of the base at factor 1; the inertia force is -M r of it.
  pure subroutine add_base_acceleration(self, acceleration)
    class(guest), intent(in) :: self
    real(rk), intent(inout) :: acceleration(3) !< [m/s2]
  end subroutine add_base_acceleration

  !> Appends the displacements that the guest's stiffness connects to the ground: they can support a
  !> body without *BOUNDARY.
  subroutine add_supports(self, node, direction)
    class(guest), intent(in) :: self
    integer, allocatable, intent(inout) :: node(:) !< positions in the mesh
    integer, allocatable, intent(inout) :: direction(:) !< 1..3, one for each node of the list
  end subroutine add_supports

  !> The description of the guest for the summary of the model.
  function describe(self) result(text)
    class(guest), intent(in) :: self
    character(:), allocatable :: text
    text = self%kind
  end function describe
end module guest_type
