!> The contract of guests: the effects that a deck brings into a model, such as a reservoir, springs
!> between meshes, a tie, a joint or a load.
!>
!> The defaults do nothing, so that a guest overrides only what it has. A step calls every guest
!> that takes part in it, in the order of guest_list; no other code checks whether a guest is
!> present. Arrays that no guest needs are not allocated.
!>
!> A guest whose force is not a constant matrix times the displacements has a history
!> (guest_history). Its constant stiffness K_g is in the matrix of the step; `update` gives the
!> remainder K_g u - f, and the iteration on inelastic solids includes it.
module guest_type
  use kinds, only: rk
  use dam_mesh, only: fe_mesh, node_tie
  use dof_numbering, only: numbering
  use guest_history, only: history, stored_work
  use matrix_pattern, only: pattern
  use row_tables, only: row_table
  implicit none
  private
  public :: guest, guest_slot, guest_reference, offered_field
  public :: stiffness_matrix, damping_matrix, mass_matrix

  !> The constant matrices of a step.
  integer, parameter :: stiffness_matrix = 1 !< K [N/m]
  integer, parameter :: damping_matrix = 2 !< C [N s/m]
  integer, parameter :: mass_matrix = 3 !< M [kg]

  !> A field on nodes that a guest offers.
  type :: offered_field
    character(:), allocatable :: name !< upper case
    character(:), allocatable :: meaning !< a noun phrase
    character(:), allocatable :: unit
    integer :: num_components = 1 !< 1 or 3
  end type offered_field

  type, abstract :: guest
    character(:), allocatable :: name !< for the log, the ledger and the list of effects
    character(:), allocatable :: kind !< 'gravity', 'reservoir', 'coupling', ..
  contains
    procedure :: add_cells
    procedure :: add_bonds
    procedure :: add_ties
    procedure :: has_matrix
    procedure :: add_matrix
    procedure :: has_force
    procedure :: add_force
    procedure :: add_base_acceleration
    procedure :: add_supports
    procedure :: start_history
    procedure :: update
    procedure :: add_work
    procedure :: num_fields
    procedure :: describe_field
    procedure :: add_field
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

  !> Appends groups of nodes that the guest connects with each other, for the search for blocks that
  !> are free to move. Default: the cells.
  subroutine add_bonds(self, groups)
    class(guest), intent(in) :: self
    type(row_table), intent(inout) :: groups !< positions of nodes in the mesh
    call self%add_cells(groups)
  end subroutine add_bonds

  !> Adds the relations between displacements that the guest imposes, in one entry, if any. The
  !> numbering eliminates them from the unknowns.
  subroutine add_ties(self, ties, used)
    class(guest), intent(in) :: self
    type(node_tie), intent(inout) :: ties(:) !< with room for the entry
    integer, intent(inout) :: used !< entries in use
  end subroutine add_ties

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

  !> The history at the start of the analysis; unallocated where the guest has none.
  subroutine start_history(self, mesh, own)
    class(guest), intent(in) :: self
    type(fe_mesh), intent(in) :: mesh
    class(history), allocatable, intent(out) :: own
  end subroutine start_history

  !> Finds the history at a trial displacement from the converged one, and adds the initial-stress
  !> force K_g u - f.
  subroutine update(self, mesh, u, dt, old, new, excess)
    class(guest), intent(in) :: self
    type(fe_mesh), intent(in) :: mesh
    real(rk), intent(in) :: u(:, :) !< (3, nodes) trial [m]
    real(rk), intent(in) :: dt !< size of the increment [s]
    class(history), intent(in) :: old !< converged
    class(history), intent(inout) :: new
    real(rk), intent(inout) :: excess(:, :) !< (3, nodes) [N]
  end subroutine update

  !> Adds the energies of a history. Stored energy counts beyond 1/2 u K_g u.
  subroutine add_work(self, own, total)
    class(guest), intent(in) :: self
    class(history), intent(in) :: own
    type(stored_work), intent(inout) :: total
  end subroutine add_work

  !> Number of fields on nodes that the guest offers. They are written with every output of fields.
  pure integer function num_fields(self)
    class(guest), intent(in) :: self
    num_fields = 0
  end function num_fields

  !> Name, meaning and unit of a field.
  subroutine describe_field(self, number, field)
    class(guest), intent(in) :: self
    integer, intent(in) :: number !< 1..num_fields
    type(offered_field), intent(out) :: field
  end subroutine describe_field

  !> Adds the values of a field on the nodes of the guest.
  subroutine add_field(self, number, own, values)
    class(guest), intent(in) :: self
    integer, intent(in) :: number !< 1..num_fields
    class(history), intent(in) :: own
    real(rk), intent(inout) :: values(:, :) !< (components, nodes)
  end subroutine add_field

  !> The description of the guest for the summary of the model.
  function describe(self) result(text)
    class(guest), intent(in) :: self
    character(:), allocatable :: text
    text = self%kind
  end function describe
end module guest_type
