!> A field of results: one row of the table in `field_table`.
module field_type
  use kinds, only: rk
  use problem_definition, only: problem
  use analysis_state, only: state
  use stress_fields, only: recovered_fields
  use write_text, only: as_text
  implicit none
  private
  public :: result_field
  public :: at_nodes, at_points, at_joints, on_faces, at_elements, place_names
  public :: by_solver, by_recovery, by_law, by_joint, by_guest, by_heat
  public :: scalar, vector, tensor, counted
  public :: values_on_nodes, values_at_points, values_of_block, values_of_joint
  public :: values_of_elements, width_of, presence

  !> Where the values of a field are defined.
  integer, parameter :: at_nodes = 1
  integer, parameter :: at_points = 2 !< integration points of solids; their means on nodes
  integer, parameter :: at_joints = 3 !< points of joints
  integer, parameter :: on_faces = 4 !< points of joints, only on drawn faces
  integer, parameter :: at_elements = 5 !< one value for each solid; their means on nodes
  character(12), parameter :: place_names(5) = ['nodes       ', 'solid points', 'joint points', &
                                                'joint faces ', 'elements    ']

  !> Part of the program that computes a field.
  character(*), parameter :: by_solver = 'equations of motion'
  character(*), parameter :: by_recovery = 'stress recovery'
  character(*), parameter :: by_law = 'material law'
  character(*), parameter :: by_joint = 'joint law'
  character(*), parameter :: by_guest = 'guest'
  character(*), parameter :: by_heat = 'temperature'

  !> Endings of the names of components.
  character(*), parameter :: scalar = ''
  character(*), parameter :: vector = '1,2,3'
  character(*), parameter :: tensor = '11,22,33,12,13,23'
  character(*), parameter :: counted = '1,2,..' !< as many as the model has

  type :: result_field
    character(:), allocatable :: name !< upper case; at most 8 letters where a deck may name it
    character(:), allocatable :: meaning !< a noun phrase
    character(:), allocatable :: remark !< sentences; '' for none
    character(:), allocatable :: unit !< in SI; '1' for a pure number
    character(:), allocatable :: provider !< part of the program that computes the field
    character(:), allocatable :: endings !< of the names of components, separated by commas
    character(:), allocatable :: stem !< before the endings
    character(:), allocatable :: requests !< keywords that may name the field, separated by ' | '
    integer :: place = at_nodes
    logical :: is_integer = .false. !< whole numbers: no mean is taken
    logical :: has_means = .false. !< also written as the mean over each element
    logical :: wants_smallest = .false. !< the envelope keeps the smallest value
    procedure(width_of), pointer :: count => null() !< null: one for each ending
    procedure(presence), pointer :: is_there => null() !< null: whenever the model has the field
    procedure(values_on_nodes), pointer :: on_nodes => null()
    procedure(values_at_points), pointer :: of_solids => null()
    procedure(values_of_block), pointer :: of_block => null()
    procedure(values_of_elements), pointer :: of_elements => null()
    procedure(values_of_joint), pointer :: of_joint => null()
  contains
    procedure :: width
    procedure :: num_endings
    procedure :: is_in
    procedure :: is_available
    procedure :: is_allowed_in
    procedure :: component
    procedure :: components
    procedure :: columns
    procedure :: is_tensor
  end type result_field

  abstract interface
    !> Number of components in this model; 0 where the model does not have the field.
    integer function width_of(self, model)
      import :: result_field, problem
      implicit none
      class(result_field), intent(in) :: self
      type(problem), intent(in) :: model
    end function width_of

    !> Does the analysis have the field now?
    logical function presence(self, model, now)
      import :: result_field, problem, state
      implicit none
      class(result_field), intent(in) :: self
      type(problem), intent(in) :: model
      type(state), intent(in) :: now
    end function presence

    !> Values on all nodes.
    subroutine values_on_nodes(self, model, now, stresses, values)
      import :: result_field, problem, state, recovered_fields, rk
      implicit none
      class(result_field), intent(in) :: self
      type(problem), intent(in) :: model
      type(state), intent(in) :: now
      type(recovered_fields), intent(inout) :: stresses !< of this increment
      real(rk), allocatable, intent(out) :: values(:, :) !< (components, nodes); unallocated: none
    end subroutine values_on_nodes

    !> Values at the integration points of some solids.
    subroutine values_at_points(self, model, now, stresses, solids, values)
      import :: result_field, problem, state, recovered_fields, rk
      implicit none
      class(result_field), intent(in) :: self
      type(problem), intent(in) :: model
      type(state), intent(in) :: now
      type(recovered_fields), intent(inout) :: stresses !< of this increment
      integer, intent(in) :: solids(:) !< numbers of the recovery plan
      real(rk), allocatable, intent(out) :: values(:, :, :) !< (components, max_points, solids)
    end subroutine values_at_points

    !> Values at the points of an inelastic block.
    subroutine values_of_block(self, model, now, block, values)
      import :: result_field, problem, state, rk
      implicit none
      class(result_field), intent(in) :: self
      type(problem), intent(in) :: model
      type(state), intent(in) :: now
      integer, intent(in) :: block !< position in the problem's list
      real(rk), allocatable, intent(out) :: values(:, :) !< (components, points); unallocated: zero
    end subroutine values_of_block

    !> Values of all elements of the mesh.
    subroutine values_of_elements(self, model, now, stresses, values)
      import :: result_field, problem, state, recovered_fields, rk
      implicit none
      class(result_field), intent(in) :: self
      type(problem), intent(in) :: model
      type(state), intent(in) :: now
      type(recovered_fields), intent(inout) :: stresses !< of this increment
      real(rk), allocatable, intent(out) :: values(:) !< (elements), zero where there is no solid
    end subroutine values_of_elements

    !> Values at the points of a joint.
    subroutine values_of_joint(self, model, now, number, values)
      import :: result_field, problem, state, rk
      implicit none
      class(result_field), intent(in) :: self
      type(problem), intent(in) :: model
      type(state), intent(in) :: now
      integer, intent(in) :: number !< position of the joint
      real(rk), allocatable, intent(out) :: values(:, :) !< (components, points); unallocated: none
    end subroutine values_of_joint
  end interface

contains

  !> Number of components in this model; 0 where the model does not have the field.
  integer function width(self, model)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    if (associated(self%count)) then
      width = self%count(model)
    else
      width = self%num_endings()
    end if
  end function width

  !> Number of components that have names of their own; 1 for a scalar.
  pure integer function num_endings(self)
    class(result_field), intent(in) :: self
    integer :: i
    num_endings = 1 + count([(self%endings(i:i) == ',', i=1, len(self%endings))])
  end function num_endings

  !> Does the model have the field?
  logical function is_in(self, model)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    is_in = self%width(model) > 0
    if (self%place == at_joints) is_in = is_in .and. size(model%joints) > 0
  end function is_in

  !> Does the analysis have the field now?
  logical function is_available(self, model, now)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    is_available = self%width(model) > 0
    if (is_available .and. associated(self%is_there)) is_available = self%is_there(model, now)
  end function is_available

  !> May a card of this keyword name the field?
  pure logical function is_allowed_in(self, keyword)
    class(result_field), intent(in) :: self
    character(*), intent(in) :: keyword !< 'NODE PRINT', ...
    is_allowed_in = index('| '//self%requests//' |', '| '//keyword//' |') > 0
  end function is_allowed_in

  !> Name of a component: 'U1', 'S11', 'TN'.
  pure function component(self, number) result(name)
    class(result_field), intent(in) :: self
    integer, intent(in) :: number !< from 1
    character(:), allocatable :: name
    integer :: i, first, last
    if (self%endings == counted) then
      name = self%stem//as_text(number)
      return
    end if
    first = 1
    do i = 2, number
      first = first + index(self%endings(first:), ',')
    end do
    last = first + index(self%endings(first:)//',', ',') - 2
    name = self%stem//self%endings(first:last)
  end function component

  !> Names of the components, separated by commas; '' for a scalar.
  pure function components(self, width) result(list)
    class(result_field), intent(in) :: self
    integer, intent(in) :: width !< number of components
    character(:), allocatable :: list
    list = ''
    if (width > 1) list = joined(self, width)
  end function components

  !> Names of the columns of a table, separated by commas; '' where the field has no component.
  pure function columns(self, width) result(list)
    class(result_field), intent(in) :: self
    integer, intent(in) :: width !< number of components
    character(:), allocatable :: list
    list = joined(self, width)
  end function columns

  !> Names of components, separated by commas.
  pure function joined(item, width) result(list)
    class(result_field), intent(in) :: item
    integer, intent(in) :: width !< number of components
    character(:), allocatable :: list
    integer :: i
    list = ''
    do i = 1, width
      if (i > 1) list = list//','
      list = list//item%component(i)
    end do
  end function joined

  !> Is the field a symmetric tensor, ordered 11 22 33 12 13 23?
  pure logical function is_tensor(self)
    class(result_field), intent(in) :: self
    is_tensor = self%endings == tensor
  end function is_tensor
end module field_type
