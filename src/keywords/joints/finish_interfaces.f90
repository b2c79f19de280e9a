!> Builds the couplings of *INTERFACE after the whole deck is read.
module finish_interfaces
  use cover_checks, only: keep_cover
  use diagnostics, only: diagnostic_list
  use element_catalogue, only: is_solid
  use kinds, only: rk
  use mesh_faces, only: face_vector
  use model_draft, only: draft, add_guest
  use small_matrix, only: cross_product
  use guest_type, only: guest
  use surface_coupling, only: build_coupling, coupling
  use surface_facets, only: list_interface_facets, list_surface_facets
  use surface_segments, only: facet_set, surface_cover
  use write_text, only: as_text
  implicit none
  private
  public :: complete_interfaces, append_coupling

  !> A corner counts as 180 degrees up to the rounding of a mesher.
  real(rk), parameter :: round_off = 1.0e-6_rk

contains

  !> Checks the IFACE4 elements and couples them to their surfaces.
  subroutine complete_interfaces(model, faults)
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: i
    if (model%problem%mesh%num_elements == 0) return
    if (.not. any(model%problem%mesh%element_type == 'IFACE4')) return
    call check_quads(model, faults)
    if (faults%has_errors()) return
    do i = 1, size(model%interfaces)
      call build_interface(i, model, faults)
    end do
  end subroutine complete_interfaces

  !> Checks that every IFACE4 belongs to an *INTERFACE, is convex, and shares no node with a solid.
  subroutine check_quads(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    logical, allocatable :: is_of_solid(:)
    integer :: i, e, a
    do i = 1, size(model%interfaces)
      if (size(model%interfaces(i)%elements) == 0) return ! reported already
    end do
    allocate (is_of_solid(model%problem%mesh%num_nodes), source=.false.)
    associate (mesh => model%problem%mesh)
      do e = 1, mesh%num_elements
        if (is_solid(mesh%element_type(e))) is_of_solid(mesh%nodes(:, e)) = .true.
      end do
      do e = 1, mesh%num_elements
        if (mesh%element_type(e) /= 'IFACE4') cycle
        if (model%interface_of_element(e) == 0) then
          call fault_quad(e, 'belongs to no interface', 'an *INTERFACE for each IFACE4 element', &
                          model, faults)
          return
        end if
        if (norm2(face_vector(mesh%x(:, mesh%nodes(1:4, e)))) <= tiny(1.0_rk)) then
          call fault_quad(e, 'has no area', 'four corners in order around it', model, faults)
          return
        end if
        if (bends_inward(mesh%x(:, mesh%nodes(1:4, e)))) then
          call fault_quad(e, 'bends inward at a corner', 'a convex quadrilateral', model, faults)
          return
        end if
        do a = 1, 4
          if (.not. is_of_solid(mesh%nodes(a, e))) cycle
          call fault_quad(e, 'shares node '//as_text(mesh%node_id(mesh%nodes(a, e)))// &
                          ' with a solid', 'separate nodes: the *INTERFACE couples them', &
                          model, faults)
          return
        end do
      end do
    end associate
  end subroutine check_quads

  !> Whether a corner lies within the triangle of the others, or two sides cross: the map of such a
  !> quad is not one to one.
  pure logical function bends_inward(x)
    real(rk), intent(in) :: x(3, 4) !< corners [m]
    real(rk) :: vector(3), to_next(3), to_last(3)
    integer :: a
    vector = face_vector(x)
    bends_inward = .false.
    do a = 1, 4
      to_next = x(:, mod(a, 4) + 1) - x(:, a)
      to_last = x(:, mod(a + 2, 4) + 1) - x(:, a)
      if (dot_product(cross_product(to_next, to_last), vector) < -round_off*sum(vector**2)) then
        bends_inward = .true.
      end if
    end do
  end function bends_inward

  !> Reports a fault at an element.
  subroutine fault_quad(e, problem, expected, model, faults)
    integer, intent(in) :: e !< position
    character(*), intent(in) :: problem, expected
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    associate (spot => model%element_origin(e))
      call model%cards(spot%card)%fault_at(faults, spot%line, 1, 'element '// &
                                           as_text(model%problem%mesh%element_id(e))//' '// &
                                           problem, expected)
    end associate
  end subroutine fault_quad

  !> Couples one set of quads to its surface.
  subroutine build_interface(number, model, faults)
    integer, intent(in) :: number
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(facet_set) :: quads, faces
    type(coupling), allocatable :: new
    type(surface_cover) :: cover
    real(rk) :: stiffness
    associate (request => model%interfaces(number), &
               place => model%cards(model%interfaces(number)%spot%card))
      if (size(request%elements) == 0 .or. request%surface == 0) return
      call list_interface_facets(model%problem%mesh, request%elements, quads)
      call list_surface_facets(model%problem%mesh, model%problem%surfaces(request%surface), faces)
      stiffness = request%stiffness
      if (stiffness <= 0.0_rk) then
        stiffness = softest(model, faces)
        if (stiffness <= 0.0_rk) then
          call place%fault(faults, 'the solids behind SURFACE have no E (a UMAT) as default '// &
                           'of STIFFNESS', 'STIFFNESS')
          return
        end if
      end if
      allocate (new)
      call build_coupling(model%problem%mesh%x, quads, faces, stiffness, request%name, &
                          'INTERFACE', &
                          new, cover)
      cover%element = request%elements
      call keep_cover(place, request%name, 'INTERFACE', cover, .false., .false., model, faults)
    end associate
    call append_coupling(model, new)
  end subroutine build_interface

  !> The smallest E of the solids behind facets, 0 if a solid has no E [Pa].
  pure real(rk) function softest(model, facets) result(young)
    type(draft), intent(in) :: model
    type(facet_set), intent(in) :: facets
    integer :: f, material
    young = huge(young)
    do f = 1, size(facets%element)
      material = model%problem%mesh%material_of_element(facets%element(f))
      young = min(young, model%problem%materials(material)%young)
    end do
    if (size(facets%element) == 0) young = 0.0_rk
  end function softest

  !> Adds springs to the guests of the problem.
  subroutine append_coupling(model, new)
    type(draft), intent(inout) :: model
    type(coupling), allocatable, intent(inout) :: new !< moved
    class(guest), allocatable :: item
    call move_alloc(new, item)
    call add_guest(model, item)
  end subroutine append_coupling
end module finish_interfaces
