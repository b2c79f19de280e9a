!> The problem while the deck is read, with the places of its definitions.
!>
!> Handlers fill the draft card by card; `finish_model` makes the problem from the draft.
module model_draft
  use applied_load, only: load, load_slot
  use deck_card, only: card
  use deck_options, only: reading_options
  use diagnostics, only: diagnostic_list
  use dof_tables, only: dof_table
  use equation_lists, only: equation_list
  use face_elements, only: face_element_list
  use guest_type, only: guest, guest_slot
  use joint_law, only: traction_law
  use id_map, only: position_table
  use kinds, only: rk
  use load_books, only: load_book
  use problem_definition, only: problem
  use set_lists, only: set_list
  use step_plan, only: output_rhythm, step
  use text_table, only: text_numbers
  use print_kinds, only: kinds_of_prints
  implicit none
  private
  public :: draft, add_guest, add_law, add_load, origin
  public :: section_request, law_request, joint_request, tie_request, interface_request
  public :: interaction_request, law_of_joint
  public :: kept_support, moved_direction
  public :: material_request, find_material_request, has_request

  !> Place of a definition: a card of the deck and one of its data lines (0: the keyword line).
  type :: origin
    integer :: card = 0, line = 0
  end type origin

  !> *SOLID SECTION.
  type :: section_request
    character(:), allocatable :: material !< upper case
    integer, allocatable :: elements(:) !< positions
    type(origin) :: spot
  end type section_request

  !> *JOINT LAW; what it takes from the solids is added when a joint is built.
  type :: law_request
    class(traction_law), allocatable :: law
    character(:), allocatable :: uplift, tail_water !< names of reservoirs, '' for none
    character(:), allocatable :: profile !< of the water: 'LINEAR' or 'OPEN'
    logical :: is_of_contact = .false. !< of one *CONTACT PAIR: no *JOINT finds it by name
    type(origin) :: spot
  end type law_request

  !> *SURFACE INTERACTION with the cards below it.
  type :: interaction_request
    character(:), allocatable :: name !< upper case
    logical :: is_tied = .false. !< never opens and never slides
    real(rk) :: stiffness = 0.0_rk !< normal [Pa/m]; 0: from the solids
    real(rk) :: friction = 0.0_rk
    real(rk) :: stick_slope = 0.0_rk !< along the surface [Pa/m]; 0: from the normal one
    integer :: behavior_card = 0, friction_card = 0 !< 0 for none
    integer :: last_card = 0 !< last card of the interaction so far
    type(origin) :: spot
  end type interaction_request

  !> *JOINT: of JOINT8 elements or between two surfaces. *CONTACT PAIR: between two surfaces.
  type :: joint_request
    character(:), allocatable :: name, law !< upper case
    integer :: contact_law = 0 !< law of a *CONTACT PAIR, position in `laws`; 0: found by name
    integer, allocatable :: elements(:) !< positions of JOINT8 elements
    integer :: slave = 0, master = 0 !< surfaces, 0 for none
    logical :: is_nodal = .true. !< points are at nodes, else Gauss points
    logical :: is_measured = .false. !< the distance of the surfaces is a gap
    logical :: is_adjusted = .false. !< overlaps are no pressure, gaps up to `adjust` are closed
    real(rk) :: adjust = 0.0_rk !< [m]
    integer, allocatable :: adjusted_nodes(:) !< positions; where allocated, only these are adjusted
    type(origin) :: spot !< line 0 for *JOINT
  end type joint_request

  !> A data line of *TIE.
  type :: tie_request
    character(:), allocatable :: name !< upper case
    integer :: slave = 0, master = 0 !< positions of surfaces
    real(rk) :: stiffness = 0.0_rk !< of springs, 0 for an exact tie [Pa/m]
    logical :: adjusts = .false. !< slave nodes are moved onto the master face
    real(rk) :: tolerance = huge(1.0_rk) !< POSITION TOLERANCE [m]
    type(origin) :: spot
  end type tie_request

  !> *INTERFACE.
  type :: interface_request
    character(:), allocatable :: name !< upper case
    integer, allocatable :: elements(:) !< positions of IFACE4 elements
    integer :: surface = 0 !< position; 0: its fault is reported
    real(rk) :: stiffness = 0.0_rk !< [Pa/m]; 0: from the solids behind the surface
    type(origin) :: spot
  end type interface_request

  !> A support of a *FREQUENCY step that the next *STATIC or *DYNAMIC step keeps.
  type :: kept_support
    integer :: step = 0 !< the *STATIC or *DYNAMIC step
    integer :: node = 0 !< position
    integer :: dof = 0 !< 1..3
    logical :: is_held = .true. !< else the *FREQUENCY step removed the support
    logical :: is_moved = .false. !< held before too, with another displacement
  end type kept_support

  !> *BOUNDARY, TYPE=ACCELERATION in one direction.
  type :: moved_direction
    logical, allocatable :: moves(:) !< (nodes) has the acceleration
    real(rk) :: value = 0.0_rk !< factor of the amplitude
    integer :: history = 0 !< amplitude
    type(origin) :: spot
  end type moved_direction

  !> What the keywords of one law say of a material, for a law that is made when the whole deck is
  !> read. A family of keywords extends the type by what it collects.
  type, abstract :: material_request
    integer :: material = 0 !< position
  contains
    procedure(complete), deferred :: complete
    procedure :: check_test => accept_test
  end type material_request

  !> One material of a list, as its cards give it.
  type :: request_slot
    class(material_request), allocatable :: item
  end type request_slot

  type :: draft
    type(card), allocatable :: cards(:) !< the whole deck
    type(problem), allocatable :: problem
    type(position_table) :: node_position, element_position !< by the user's ids
    type(origin), allocatable :: node_origin(:), element_origin(:)
    type(set_list) :: node_sets, element_sets
    type(face_element_list) :: faces !< elements of faces beside the solids
    ! In use of `problem` while the deck is read; the lists have room for all cards.
    integer :: num_surfaces = 0, num_amplitudes = 0, num_materials = 0
    type(text_numbers) :: surface_of_name, amplitude_of_name, material_of_name !< positions
    type(origin), allocatable :: surface_origin(:), material_origin(:), test_origin(:)
    character(5), allocatable :: record_unit(:) !< (amplitudes) UNIT, '' for none
    real(rk), allocatable :: record_factor(:) !< (amplitudes) of a unit that only the file names
    logical :: is_from_cae = .false. !< a comment names Abaqus/CAE
    logical, allocatable :: has_element(:) !< (nodes) an element has the node
    type(reading_options) :: options !< of the command line
    integer :: num_sections = 0 !< in use of `sections`, which has room for all cards
    type(section_request), allocatable :: sections(:)
    type(law_request), allocatable :: laws(:)
    type(joint_request), allocatable :: joints(:)
    type(interaction_request), allocatable :: interactions(:)
    type(origin), allocatable :: clearances(:) !< cards *CLEARANCE
    type(tie_request), allocatable :: ties(:)
    type(interface_request), allocatable :: interfaces(:)
    type(equation_list) :: equations
    type(request_slot), allocatable :: material_requests(:)
    integer, allocatable :: joint_of_element(:) !< position in `joints`, 0 for none
    integer, allocatable :: interface_of_element(:) !< position in `interfaces`, 0 for none
    character(:), allocatable :: mass_kind !< MASS of *SOLID SECTION once it is given
    integer :: num_loads = 0 !< in use of model%loads, which grows by doubling
    type(load_book) :: active_loads
    type(dof_table) :: supports, point_forces
    type(dof_table) :: last_supports !< after the last step that moves the model
    type(kept_support), allocatable :: kept_supports(:) !< one for each step that keeps some
    ! The card being read.
    integer :: current = 0 !< its position in `cards`
    logical :: is_right = .true. !< it agrees with its specification
    logical :: is_in_step = .false.
    ! The step being read.
    type(step) :: now
    type(origin) :: step_origin
    integer :: num_steps = 0 !< closed so far; model%steps has room for all
    integer, allocatable :: procedure_card(:) !< card of the procedure of each step
    integer :: current_procedure = 0 !< card of the procedure of the step being read
    real(rk) :: total_time = 0.0_rk !< at the start of the step [s]
    type(moved_direction) :: moved(3) !< accelerations of supports in this step
    logical :: is_shaken(3) = .false. !< by accelerations of supports of an earlier step
    logical :: holds_motion = .false. !< a base motion of an earlier step keeps its last value
    logical :: has_new_nodal = .false. !< *NODE FILE or a similar keyword in this step
    logical :: has_new_elemental = .false. !< *EL FILE or a similar keyword in this step
    type(output_rhythm) :: rhythm !< of the last *OUTPUT
    integer :: next_checkpoint_frequency = -1 !< of a *RESTART before the next step; -1: none
    logical :: output_is_history = .false. !< the last *OUTPUT opened histories
    logical :: prints_given(size(kinds_of_prints)) = .false. !< kinds that this step has requested
  contains
    procedure :: here
  end type draft

  abstract interface
    !> Checks the request and gives the material its law. The request is not in the draft meanwhile.
    subroutine complete(self, model, faults)
      import :: material_request, draft, diagnostic_list
      implicit none
      class(material_request), intent(inout) :: self
      type(draft), intent(inout) :: model
      type(diagnostic_list), intent(inout) :: faults
    end subroutine complete
  end interface

contains

  !> The place of a data line of the card being read.
  pure type(origin) function here(self, line)
    class(draft), intent(in) :: self
    integer, intent(in) :: line !< 0: the keyword line
    here%card = self%current
    here%line = line
  end function here

  !> Default: any *MATERIAL TEST suits the law.
  subroutine accept_test(self, number, model, faults)
    class(material_request), intent(in) :: self !< complete
    integer, intent(in) :: number !< of the test
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
  end subroutine accept_test

  !> Position of the request, of the type of `blank`, for the material that is being read; where
  !> there is none, `blank` becomes it.
  subroutine find_material_request(model, blank, found)
    type(draft), intent(inout) :: model
    class(material_request), intent(in) :: blank
    integer, intent(out) :: found
    type(request_slot), allocatable :: longer(:)
    integer :: material, num, i
    material = model%num_materials
    num = size(model%material_requests)
    do found = 1, num
      associate (item => model%material_requests(found)%item)
        if (item%material == material .and. same_type_as(item, blank)) return
      end associate
    end do
    allocate (longer(num + 1))
    do i = 1, num
      call move_alloc(model%material_requests(i)%item, longer(i)%item)
    end do
    allocate (longer(num + 1)%item, source=blank)
    longer(num + 1)%item%material = material
    call move_alloc(longer, model%material_requests)
  end subroutine find_material_request

  !> Does a request in the draft concern the material?
  pure logical function has_request(model, material)
    type(draft), intent(in) :: model
    integer, intent(in) :: material !< position
    integer :: i
    has_request = .false.
    do i = 1, size(model%material_requests)
      if (.not. allocated(model%material_requests(i)%item)) cycle
      if (model%material_requests(i)%item%material == material) has_request = .true.
    end do
  end function has_request

  subroutine add_law(model, new)
    type(draft), intent(inout) :: model
    type(law_request), intent(in) :: new
    type(law_request), allocatable :: longer(:)
    integer :: i
    allocate (longer(size(model%laws) + 1))
    do i = 1, size(model%laws)
      longer(i) = model%laws(i)
    end do
    longer(size(longer)) = new
    call move_alloc(longer, model%laws)
  end subroutine add_law

  !> Position of the law of a joint in `laws`, 0 for a name that no law has.
  pure integer function law_of_joint(model, joint) result(found)
    type(draft), intent(in) :: model
    integer, intent(in) :: joint !< position in `joints`
    found = model%joints(joint)%contact_law
    if (found > 0) return
    do found = 1, size(model%laws)
      if (model%laws(found)%is_of_contact) cycle
      if (model%laws(found)%law%name == model%joints(joint)%law) return
    end do
    found = 0
  end function law_of_joint

  !> Adds a load to the list of the problem, which grows by doubling, at position `num_loads`.
  subroutine add_load(model, item, name, family, target)
    type(draft), intent(inout) :: model
    class(load), allocatable, intent(inout) :: item !< moved into the list
    character(*), intent(in) :: name !< in the log and the list of effects
    character(*), intent(in) :: family !< its keyword
    character(*), intent(in) :: target !< place of the load
    type(load_slot), allocatable :: longer(:)
    integer :: i
    item%name = name
    item%family = family
    item%target = target
    if (model%num_loads == size(model%problem%loads)) then
      allocate (longer(max(8, 2*model%num_loads)))
      do i = 1, model%num_loads
        call move_alloc(model%problem%loads(i)%item, longer(i)%item)
      end do
      call move_alloc(longer, model%problem%loads)
    end if
    model%num_loads = model%num_loads + 1
    call move_alloc(item, model%problem%loads(model%num_loads)%item)
  end subroutine add_load

  !> Adds a guest that acts in every step.
  subroutine add_guest(model, item)
    type(draft), intent(inout) :: model
    class(guest), allocatable, intent(inout) :: item !< with name and kind; moved into the list
    type(guest_slot), allocatable :: longer(:)
    integer :: i
    associate (num => size(model%problem%guests))
      allocate (longer(num + 1))
      do i = 1, num
        call move_alloc(model%problem%guests(i)%item, longer(i)%item)
      end do
      call move_alloc(item, longer(num + 1)%item)
    end associate
    call move_alloc(longer, model%problem%guests)
  end subroutine add_guest
end module model_draft
