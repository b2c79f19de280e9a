!> Warns of pressure and water on a face between two solids: the load pushes them apart, and its
!> resultant has the sign opposite to that on the outer face of the same elements.
module check_inner_faces
  use check_pressures, only: card_of_faces, find_faces
  use dam_mesh, only: surface
  use diagnostics, only: diagnostic_list
  use element_catalogue, only: is_solid
  use kinds, only: rk
  use mesh_faces, only: count_corners, face_nodes, face_table, find_face, insert_face, open_table
  use model_draft, only: draft
  use write_text, only: as_text
  implicit none
  private
  public :: warn_of_inner_faces

  !> The faces of all loads, and the solids behind them.
  type :: loaded_faces
    type(face_table) :: table
    integer, allocatable :: load(:), element(:), face(:) !< of each face
    integer, allocatable :: behind(:) !< element that has the same face, 0 for none
  end type loaded_faces

contains

  !> One warning for each load. The deck must have no errors.
  subroutine warn_of_inner_faces(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(loaded_faces) :: list
    integer, allocatable :: first(:), num(:) !< (loads) first such face, and how many there are
    integer :: i, s
    call list_faces(model, list)
    if (list%table%num_faces == 0) return
    call find_solids_behind(model, list)
    allocate (first(size(model%problem%loads)), num(size(model%problem%loads)), source=0)
    do i = list%table%num_faces, 1, -1
      if (list%behind(i) == 0) cycle
      if (.not. is_inside(model, list, i)) cycle
      first(list%load(i)) = i
      num(list%load(i)) = num(list%load(i)) + 1
    end do
    do i = 1, size(num)
      if (num(i) == 0) cycle
      s = first_step(model, i, list%element(first(i)))
      call warn(model, list, first(i), num(i), s, faults)
    end do
  end subroutine warn_of_inner_faces

  !> The faces that pressures and reservoirs push.
  subroutine list_faces(model, list)
    type(draft), intent(in) :: model
    type(loaded_faces), intent(out) :: list
    type(surface) :: faces
    integer :: i, k, kind, number, num
    num = 0
    do i = 1, size(model%problem%loads)
      call find_faces(model%problem%loads(i)%item, faces, kind)
      if (kind > 0) num = num + size(faces%element)
    end do
    allocate (list%load(num), list%element(num), list%face(num), list%behind(num), source=0)
    if (num == 0) return
    call open_table(model%problem%mesh%num_nodes, num, list%table)
    do i = 1, size(model%problem%loads)
      call find_faces(model%problem%loads(i)%item, faces, kind)
      if (kind == 0) cycle
      do k = 1, size(faces%element)
        call insert_face(list%table, face_nodes(model%problem%mesh, faces%element(k), &
                                                faces%face(k)), number)
        list%load(number) = i
        list%element(number) = faces%element(k)
        list%face(number) = faces%face(k)
      end do
    end do
  end subroutine list_faces

  !> Looks in all solids for the loaded faces. A collapsed face of a wedge has no area.
  subroutine find_solids_behind(model, list)
    type(draft), intent(in) :: model
    type(loaded_faces), intent(inout) :: list
    integer :: e, face, number, nodes(4)
    associate (mesh => model%problem%mesh)
      do e = 1, mesh%num_elements
        if (.not. is_solid(mesh%element_type(e))) cycle
        do face = 1, 6
          nodes = face_nodes(mesh, e, face)
          number = find_face(list%table, nodes)
          if (number == 0) cycle
          if (count_corners(nodes) < 3) cycle
          do while (number > 0)
            if (list%element(number) /= e) list%behind(number) = e
            number = find_face(list%table, nodes, number)
          end do
        end do
      end do
    end associate
  end subroutine find_solids_behind

  !> Whether the element behind a face is there as soon as the load acts. A later stage may put an
  !> element on a face that a load of an earlier step pushes.
  pure logical function is_inside(model, list, i)
    type(draft), intent(in) :: model
    type(loaded_faces), intent(in) :: list
    integer, intent(in) :: i !< number of the face
    integer :: s
    s = first_step(model, list%load(i), list%element(i))
    is_inside = s > 0
    if (is_inside) is_inside = is_there(model, list%behind(i), s)
  end function is_inside

  !> The first step in which a load acts on an element that is there; 0 for none.
  pure integer function first_step(model, load, element) result(s)
    type(draft), intent(in) :: model
    integer, intent(in) :: load
    integer, intent(in) :: element !< position
    do s = 1, size(model%problem%steps)
      if (.not. is_there(model, element, s)) cycle
      associate (works => model%problem%steps(s)%loads)
        if (any(works%load == load .and. (works%amplitude > 0 .or. &
                                          abs(works%end_factor) > 0.0_rk))) return
      end associate
    end do
    s = 0
  end function first_step

  pure logical function is_there(model, element, s)
    type(draft), intent(in) :: model
    integer, intent(in) :: element !< position
    integer, intent(in) :: s !< step
    is_there = .true.
    if (allocated(model%problem%stages%is_absent)) then
      is_there = .not. model%problem%stages%is_absent(element, s)
    end if
  end function is_there

  subroutine warn(model, list, i, num, s, faults)
    type(draft), intent(in) :: model
    type(loaded_faces), intent(in) :: list
    integer, intent(in) :: i !< number of the first face
    integer, intent(in) :: num !< such faces of its load
    integer, intent(in) :: s !< step
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: text
    associate (mesh => model%problem%mesh, item => model%problem%loads(list%load(i))%item)
      text = 'face S'//as_text(list%face(i))//' of element '// &
             as_text(mesh%element_id(list%element(i)))//' lies inside the solid: element '// &
             as_text(mesh%element_id(list%behind(i)))//" is behind it, and '"//item%target// &
             "' pushes both elements apart"
      if (num > 1) text = text//'; '//as_text(num)//' such faces'
      call model%cards(card_of_faces(model, s, item))%warn(faults, text, &
                                                           'outer faces of the solid')
    end associate
  end subroutine warn
end module check_inner_faces
