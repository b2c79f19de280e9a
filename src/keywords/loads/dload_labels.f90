!> The list of labels of *DLOAD: what acts on elements. Choices, help, the check of the numbers and
!> the message "expected one of" are made from it. A new label is a procedure that makes its load,
!> and a line in `list_labels`.
module dload_labels
  use applied_load, only: load
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use element_catalogue, only: is_solid
  use enter_load, only: put_load
  use kinds, only: rk
  use load_gravity, only: gravity_load
  use load_pressure, only: face_of_word, faces_of_elements, pressure_load
  use mesh_faces, only: count_corners, face_nodes
  use model_draft, only: draft
  use write_text, only: as_text
  implicit none
  private
  public :: dload_label, num_labels, list_labels, find_label, choices_of_labels, labels_in_words, &
            meaning_of_labels, elements_in_words, in_place_of, pattern_of

  type :: dload_label
    character(:), allocatable :: name !< without the number of a face
    character(:), allocatable :: meaning !< numbers and what they mean, for the help
    character(:), allocatable :: expected !< the numbers, for messages
    integer :: num_faces = 0 !< the label ends with the number of a face, 1 to num_faces; 0 none
    integer :: num_numbers = 1 !< that a line may give
    integer :: fewest_numbers = 1 !< that a line must give
    procedure(put_rows), pointer, nopass :: put => null()
  end type dload_label

  integer, parameter :: num_labels = 3
  character(*), parameter :: gravity_numbers = 'g [m/s2] and the direction x, y, z'

  abstract interface
    !> Adds the load of one line to the step.
    subroutine put_rows(this, line, elements, history, model, faults)
      import :: card, draft, diagnostic_list
      implicit none
      type(card), intent(in) :: this
      integer, intent(in) :: line
      integer, intent(in) :: elements(:) !< positions
      integer, intent(in) :: history !< amplitude, 0 for none
      type(draft), intent(inout) :: model
      type(diagnostic_list), intent(inout) :: faults
    end subroutine put_rows
  end interface

contains

  !> All labels.
  subroutine list_labels(labels)
    type(dload_label), intent(out) :: labels(num_labels)
    labels(1) = dload_label('GRAV', 'GRAV, g, x, y, z: an acceleration along (x, y, z), a '// &
                            'vector of any length.', gravity_numbers, &
                            num_numbers=4, fewest_numbers=1, put=put_gravity)
    labels(2) = dload_label('P', 'P1..P6, p: pressure on a face, positive towards the element.', &
                            'a pressure [Pa]', num_faces=6, put=put_pressure)
    labels(3) = dload_label('HP', 'HP1..HP6, p, z_top, z_ref: hydrostatic along axis 3, zero '// &
                            'at z_top and above, p at z_ref.', 'p [Pa], z_top, z_ref [m]', &
                            num_faces=6, num_numbers=3, fewest_numbers=3, put=put_water)
  end subroutine list_labels

  !> What the elements of a line are called: 1 for 01.
  pure function elements_in_words(this, line) result(name)
    type(card), intent(in) :: this
    integer, intent(in) :: line
    character(:), allocatable :: name
    name = this%word_at(line, 1)
    if (len(name) == 0) name = 'ALL SOLIDS'
    if (this%is_integer_at(line, 1)) name = as_text(this%integer_at(line, 1))
  end function elements_in_words

  !> Position of the label that a word names, 0 for another word.
  pure integer function find_label(labels, word) result(found)
    type(dload_label), intent(in) :: labels(:)
    character(*), intent(in) :: word !< upper case
    integer :: face
    do found = 1, size(labels)
      do face = min(1, labels(found)%num_faces), labels(found)%num_faces
        if (word == word_of(labels(found), face)) return
      end do
    end do
    found = 0
  end function find_label

  !> A label with the number of its face.
  pure function word_of(label, face) result(word)
    type(dload_label), intent(in) :: label
    integer, intent(in) :: face !< 1..9, 0 for none
    character(:), allocatable :: word
    word = label%name
    if (face > 0) word = word//achar(iachar('0') + face)
  end function word_of

  !> All words, as the choices of a column: 'GRAV | P1 | ...'.
  function choices_of_labels() result(choices)
    character(:), allocatable :: choices
    type(dload_label) :: labels(num_labels)
    integer :: i, face
    call list_labels(labels)
    choices = ''
    do i = 1, size(labels)
      do face = min(1, labels(i)%num_faces), labels(i)%num_faces
        choices = choices//' | '//word_of(labels(i), face)
      end do
    end do
    choices = choices(4:)
  end function choices_of_labels

  !> All labels as a message lists them: 'GRAV, P1..P6 or HP1..HP6'.
  function labels_in_words() result(text)
    character(:), allocatable :: text
    type(dload_label) :: labels(num_labels)
    integer :: i
    call list_labels(labels)
    text = ''
    do i = 1, size(labels)
      if (i > 1 .and. i < size(labels)) text = text//', '
      if (i > 1 .and. i == size(labels)) text = text//' or '
      text = text//word_of(labels(i), min(1, labels(i)%num_faces))
      if (labels(i)%num_faces > 0) text = text//'..'//word_of(labels(i), labels(i)%num_faces)
    end do
  end function labels_in_words

  !> What to take in place of a label of other programs; '' for another word.
  pure function in_place_of(word) result(text)
    character(*), intent(in) :: word !< upper case
    character(:), allocatable :: text
    character(*), parameter :: force = 'a *DENSITY, and GRAV with the force '// &
                               'per volume over the density as g'
    character(*), parameter :: others = 'GRAV, P1..P6 or HP1..HP6'
    select case (word)
    case ('BX')
      text = force//', along 1., 0., 0.'
    case ('BY')
      text = force//', along 0., 1., 0.'
    case ('BZ')
      text = force//', along 0., 0., 1.'
    case ('BXNU', 'BYNU', 'BZNU')
      text = force//', and AMPLITUDE for its history'
    case ('CENTRIF', 'CENT')
      text = others//'; a centrifugal load is not available'
    case ('ROTA')
      text = others//'; a load by angular acceleration is not available'
    case ('CORIO')
      text = others//'; a Coriolis load is not available'
    case default
      text = ''
    end select
  end function in_place_of

  !> The meanings of all labels.
  function meaning_of_labels() result(text)
    character(:), allocatable :: text
    type(dload_label) :: labels(num_labels)
    integer :: i
    call list_labels(labels)
    text = ''
    do i = 1, size(labels)
      text = text//' '//labels(i)%meaning
    end do
    text = text(2:)
  end function meaning_of_labels

  subroutine put_gravity(this, line, elements, history, model, faults)
    type(card), intent(in) :: this
    integer, intent(in) :: line, elements(:), history
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(gravity_load) :: weight
    class(load), allocatable :: item
    character(:), allocatable :: target
    real(rk) :: direction(3)
    integer :: num_given
    num_given = this%num_fields(line) - 3
    if (num_given == 1 .or. num_given == 2) then
      call this%fault_at(faults, line, num_given + 4, 'the direction of gravity has '// &
                         as_text(num_given)//' of 3 components', gravity_numbers)
      return
    end if
    direction = [this%real_at(line, 4), this%real_at(line, 5), this%real_at(line, 6)]
    if (norm2(direction) <= 0.0_rk) then
      call this%fault_at(faults, line, 4, 'gravity without a direction', &
                         'x, y, z of the direction')
      return
    end if
    direction = direction/norm2(direction)
    weight%kind = 'gravity'
    weight%elements = elements
    weight%acceleration = direction
    target = elements_in_words(this, line)
    allocate (item, source=weight)
    call put_load(model, item, 'gravity '//target, 'DLOAD', target//' GRAV', &
                  pattern_of(direction, size(elements)), this%real_at(line, 3), history)
  end subroutine put_gravity

  subroutine put_pressure(this, line, elements, history, model, faults)
    type(card), intent(in) :: this
    integer, intent(in) :: line, elements(:), history
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    call put_push(this, line, elements, pressure_load(), history, model, faults)
  end subroutine put_pressure

  subroutine put_water(this, line, elements, history, model, faults)
    type(card), intent(in) :: this
    integer, intent(in) :: line, elements(:), history
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    real(rk) :: top, reference
    top = this%real_at(line, 4)
    reference = this%real_at(line, 5)
    if (reference >= top) then
      call this%fault_at(faults, line, 5, "found '"//this%text_at(line, 5)//"'", &
                         'z_ref below z_top, '//this%text_at(line, 4))
      return
    end if
    call warn_of_dry_faces(this, line, elements, top, model, faults)
    call put_push(this, line, elements, &
                  pressure_load(is_hydrostatic=.true., top=top, reference=reference), &
                  history, model, faults)
  end subroutine put_water

  !> The hydrostatic pressure is zero at its top and above.
  subroutine warn_of_dry_faces(this, line, elements, top, model, faults)
    type(card), intent(in) :: this
    integer, intent(in) :: line, elements(:)
    real(rk), intent(in) :: top !< height of pressure zero [m]
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: i, face
    face = face_of_word(this%word_at(line, 2))
    associate (mesh => model%problem%mesh)
      if (size(elements) == 0) return
      if (.not. all(is_solid(mesh%element_type(elements)))) return ! reported
      do i = 1, size(elements)
        if (minval(mesh%x(3, face_nodes(mesh, elements(i), face))) < top) return
      end do
    end associate
    call this%warn_at(faults, line, 4, 'the load has no effect: no face has a point below '// &
                      'z_top, '//this%text_at(line, 4))
  end subroutine warn_of_dry_faces

  !> Adds a pressure on the face that the label names.
  subroutine put_push(this, line, elements, variation, history, model, faults)
    type(card), intent(in) :: this
    integer, intent(in) :: line, elements(:), history
    type(pressure_load), intent(in) :: variation !< of the pressure over the height
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(pressure_load) :: push
    class(load), allocatable :: item
    character(:), allocatable :: where_it_acts
    if (.not. all(is_solid(model%problem%mesh%element_type(elements)))) then
      call this%fault_at(faults, line, 1, 'pressure on an element that is not a solid', &
                         'solid elements')
      return
    end if
    call check_areas(this, line, elements, model, faults)
    push = variation
    push%kind = 'pressure'
    push%pressure = 1.0_rk
    push%faces = faces_of_elements(elements, face_of_word(this%word_at(line, 2)))
    where_it_acts = elements_in_words(this, line)//' '//this%word_at(line, 2)
    allocate (item, source=push)
    call put_load(model, item, 'pressure '//where_it_acts, 'DLOAD', where_it_acts, &
                  pattern_of([push%top, push%reference], size(elements)), &
                  this%real_at(line, 3), history)
  end subroutine put_push

  !> A pressure has no effect on a face that has collapsed.
  subroutine check_areas(this, line, elements, model, faults)
    type(card), intent(in) :: this
    integer, intent(in) :: line, elements(:)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: problem
    logical :: has_area(size(elements))
    integer :: i, face
    face = face_of_word(this%word_at(line, 2))
    associate (mesh => model%problem%mesh)
      has_area = [(count_corners(face_nodes(mesh, elements(i), face)) >= 3, i=1, size(elements))]
      if (all(has_area)) return
      i = findloc(has_area, .false., dim=1)
      problem = 'face S'//as_text(face)//' of element '//as_text(mesh%element_id(elements(i)))// &
                ' has no area'
    end associate
    if (.not. any(has_area)) then
      call this%fault_at(faults, line, 2, problem, 'a face that has not collapsed')
      return
    end if
    i = count(.not. has_area)
    if (i > 1) problem = problem//', nor have '//as_text(i - 1)//' more of the set'
    call this%warn_at(faults, line, 2, problem//': the pressure has no effect there ('// &
                      as_text(i)//' of '//as_text(size(elements))//' faces)')
  end subroutine check_areas

  !> Numbers as a text to compare: equal texts mean equal patterns. A set or a surface may have
  !> grown since an earlier step.
  pure function pattern_of(numbers, num_members) result(text)
    real(rk), intent(in) :: numbers(:)
    integer, intent(in) :: num_members !< elements of the set, or faces of the surface
    character(24*(size(numbers) + 1)) :: text
    write (text, '(*(es24.16e3))') numbers, real(num_members, rk)
  end function pattern_of
end module dload_labels
