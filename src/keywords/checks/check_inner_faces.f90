!> Warns of pressure and water on a face between two solids: the load pushes them apart, and its
!> resultant has the sign opposite to that on the outer face of the same elements.
module check_inner_faces
  use check_pressures, only: find_faces
  use dam_mesh, only: surface
  use diagnostics, only: diagnostic_list
  use element_catalogue, only: is_solid
  use kinds, only: rk
  use load_cards, only: load_card_list
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

  !> The steps in which each load acts.
  type :: acting_steps
    integer, allocatable :: first(:) !< (loads) its first entry, 0 for none
    integer, allocatable :: step(:), next(:) !< (entries) step, and entry of the next step or 0
  end type acting_steps

contains

  !> One warning for each load. The deck must have no errors.
  subroutine warn_of_inner_faces(model, cards, faults)
    type(draft), intent(in) :: model
    type(load_card_list), intent(in) :: cards !< of the deck
    type(diagnostic_list), intent(inout) :: faults
    type(loaded_faces) :: list
    type(acting_steps) :: steps
    integer, allocatable :: first(:), num(:) !< (loads) first such face, and how many there are
    integer :: i, s
    call list_faces(model, list)
    if (list%table%num_faces == 0) return
    call find_solids_behind(model, list)
    if (all(list%behind == 0)) return
    call list_steps(model, steps)
    allocate (first(size(model%problem%loads)), num(size(model%problem%loads)), source=0)
    do i = list%table%num_faces, 1, -1
      if (list%behind(i) == 0) cycle
      if (.not. is_inside(model, list, steps, i)) cycle
      first(list%load(i)) = i
      num(list%load(i)) = num(list%load(i)) + 1
    end do
    do i = 1, size(num)
      if (num(i) == 0) cycle
      s = first_step(model, steps, i, list%element(first(i)))
      call warn(model, cards, list, first(i), num(i), s, faults)
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
  pure logical function is_inside(model, list, steps, i)
    type(draft), intent(in) :: model
    type(loaded_faces), intent(in) :: list
    type(acting_steps), intent(in) :: steps
    integer, intent(in) :: i !< number of the face
    integer :: s
    s = first_step(model, steps, list%load(i), list%element(i))
    is_inside = s > 0
    if (is_inside) is_inside = model%problem%stages%has_element(list%behind(i), s)
  end function is_inside

  !> Lists the steps of each load whose factor is not zero.
  pure subroutine list_steps(model, list)
    type(draft), intent(in) :: model
    type(acting_steps), intent(out) :: list
    integer :: s, i, num
    num = 0
    do s = 1, size(model%problem%steps)
      num = num + size(model%problem%steps(s)%loads)
    end do
    allocate (list%first(size(model%problem%loads)), source=0)
    allocate (list%step(num), list%next(num))
    num = 0
    do s = size(model%problem%steps), 1, -1
      do i = 1, size(model%problem%steps(s)%loads)
        associate (work => model%problem%steps(s)%loads(i))
          if (work%amplitude == 0 .and. abs(work%end_factor) <= 0.0_rk) cycle
          num = num + 1
          list%step(num) = s
          list%next(num) = list%first(work%load)
          list%first(work%load) = num
        end associate
      end do
    end do
  end subroutine list_steps

  !> The first step in which a load acts on an element that is there; 0 for none.
  pure integer function first_step(model, steps, load, element) result(s)
    type(draft), intent(in) :: model
    type(acting_steps), intent(in) :: steps
    integer, intent(in) :: load
    integer, intent(in) :: element !< position
    integer :: i
    i = steps%first(load)
    do while (i > 0)
      s = steps%step(i)
      if (model%problem%stages%has_element(element, s)) return
      i = steps%next(i)
    end do
    s = 0
  end function first_step

  subroutine warn(model, cards, list, i, num, s, faults)
    type(draft), intent(in) :: model
    type(load_card_list), intent(in) :: cards
    type(loaded_faces), intent(in) :: list
    integer, intent(in) :: i !< number of the first face
    integer, intent(in) :: num !< such faces of its load
    integer, intent(in) :: s !< step
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: text
    integer :: found
    associate (mesh => model%problem%mesh, item => model%problem%loads(list%load(i))%item)
      text = 'face S'//as_text(list%face(i))//' of element '// &
             as_text(mesh%element_id(list%element(i)))//' lies inside the solid: element '// &
             as_text(mesh%element_id(list%behind(i)))//" is behind it, and '"//item%target// &
             "' pushes both elements apart"
      if (num > 1) text = text//'; '//as_text(num)//' such faces'
      found = cards%find(item%family, item%target, s, otherwise=model%procedure_card(s))
      call model%cards(found)%warn(faults, text, 'outer faces of the solid')
    end associate
  end subroutine warn
end module check_inner_faces
