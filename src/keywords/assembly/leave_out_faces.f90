!> Elements of lines and faces, as meshes from Gmsh hold them beside the solids: they are left out,
!> with a note, and so are their numbers in element sets.
module leave_out_faces
  use card_rewrite, only: card_rewriter
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use face_elements, only: face_element_list
  use growing_lists, only: append
  use sorted_lists, only: contains_position, sorted_unique
  use write_text, only: as_text
  implicit none
  private
  public :: leave_out

  !> Types that Gmsh gives to lines, triangles and quadrilaterals.
  character(4), parameter :: types(*) = ['T3D2', 'T3D3', 'CPS3', 'CPS4', 'CPS6', 'CPS8', 'S3  ', &
                                         'S4  ', 'S6  ', 'S8  ', 'S8R ', 'S4R ', 'M3D3', 'M3D4', &
                                         'B31 ']
  character(4), parameter :: triangles(*) = ['CPS3', 'CPS6', 'S3  ', 'S6  ', 'M3D3']

contains

  !> Leaves the elements out of a deck without parts. A deck that gives them a section of their own
  !> keeps them: then they carry loads, and *ELEMENT reports them.
  subroutine leave_out(cards, faces, faults)
    type(card), allocatable, intent(inout) :: cards(:)
    type(face_element_list), intent(inout) :: faces !< what is left out
    type(diagnostic_list), intent(inout) :: faults
    integer, allocatable :: ids(:)
    logical, allocatable :: is_kept(:)
    integer :: i
    if (any([(is_structure(cards(i)), i=1, size(cards))])) return
    if (.not. any([(is_left_out(cards(i)), i=1, size(cards))])) return
    if (.not. any([(has_solids(cards(i)), i=1, size(cards))])) return
    allocate (is_kept(size(cards)), source=.true.)
    call find_ids(cards, is_kept, ids)
    if (has_own_section(cards, is_kept, ids)) return
    call keep_faces(cards, is_kept, faces)
    do i = 1, size(cards)
      if (.not. is_kept(i)) then
        call cards(i)%ignore(faults, 'elements '//cards(i)%word('TYPE')//' ('// &
                             as_text(cards(i)%num_lines)//') have no effect and are left out: '// &
                             'only solids carry loads')
      else if (is_listed_set(cards(i))) then
        call shorten_set(cards(i), ids, is_kept(i))
      end if
    end do
    cards = pack_cards(cards, is_kept)
  end subroutine leave_out

  !> Parts, or a section that only shells, beams, membranes or trusses have.
  logical function is_structure(this)
    type(card), intent(in) :: this
    is_structure = this%keyword == 'PART' .or. this%keyword == 'ASSEMBLY' .or. &
                   this%keyword == 'SHELL SECTION' .or. this%keyword == 'BEAM SECTION' .or. &
                   this%keyword == 'MEMBRANE SECTION'
  end function is_structure

  logical function is_left_out(this)
    type(card), intent(in) :: this
    is_left_out = this%keyword == 'ELEMENT'
    if (is_left_out) is_left_out = any(types == this%word('TYPE'))
  end function is_left_out

  logical function has_solids(this)
    type(card), intent(in) :: this
    has_solids = this%keyword == 'ELEMENT'
    if (has_solids) has_solids = index(this%word('TYPE'), 'C3D') == 1
  end function has_solids

  !> Keeps the nodes of faces and their sets, for *SURFACE.
  subroutine keep_faces(cards, is_kept, faces)
    type(card), intent(in) :: cards(:)
    logical, intent(in) :: is_kept(:)
    type(face_element_list), intent(inout) :: faces
    integer :: i, line, num_corners, nodes(4), first, k
    do i = 1, size(cards)
      if (is_kept(i)) cycle
      num_corners = 4
      if (any(triangles == cards(i)%word('TYPE'))) num_corners = 3
      if (scan(cards(i)%word('TYPE'), 'TB') == 1) cycle ! lines
      first = faces%num_faces + 1
      do line = 1, cards(i)%num_lines
        nodes = [(cards(i)%integer_at(line, 1 + min(k, num_corners)), k=1, 4)]
        call faces%add(cards(i)%integer_at(line, 1), nodes)
      end do
      if (cards(i)%has('ELSET')) then
        call faces%sets%add(cards(i)%word('ELSET'), [(k, k=first, faces%num_faces)])
      end if
    end do
    do i = 1, size(cards)
      if (is_listed_set(cards(i))) call keep_set(cards(i), faces)
    end do
  end subroutine keep_faces

  !> Keeps the faces of a set.
  subroutine keep_set(this, faces)
    type(card), intent(in) :: this
    type(face_element_list), intent(inout) :: faces
    integer, allocatable :: members(:)
    integer :: line, field, position, num
    allocate (members(0))
    num = 0
    do line = 1, this%num_lines
      do field = 1, this%num_fields(line)
        if (.not. this%is_integer_at(line, field)) cycle
        position = faces%position%find(this%integer_at(line, field))
        if (position > 0) call append(members, num, position)
      end do
    end do
    if (num > 0) call faces%sets%add(this%word('ELSET'), members(:num))
  end subroutine keep_set

  !> Whether a *SOLID SECTION belongs to a set that holds none but such elements.
  logical function has_own_section(cards, is_kept, ids) result(has_one)
    type(card), intent(in) :: cards(:)
    logical, intent(in) :: is_kept(:)
    integer, intent(in) :: ids(:) !< of these elements, sorted
    logical :: is_of_them, is_of_others, stays
    integer :: i, j
    has_one = .true.
    do i = 1, size(cards)
      if (cards(i)%keyword /= 'SOLID SECTION') cycle
      is_of_them = .false.
      is_of_others = .false.
      do j = 1, size(cards)
        if (cards(j)%keyword /= 'ELEMENT' .and. cards(j)%keyword /= 'ELSET') cycle
        if (cards(j)%word('ELSET') /= cards(i)%word('ELSET')) cycle
        stays = is_kept(j)
        if (is_listed_set(cards(j))) then
          stays = len(another_member(cards(j), ids)) > 0 .or. .not. names_any(cards(j), ids)
        end if
        is_of_them = is_of_them .or. .not. stays
        is_of_others = is_of_others .or. stays
      end do
      if (is_of_them .and. .not. is_of_others) return
    end do
    has_one = .false.
  end function has_own_section

  logical function is_listed_set(this)
    type(card), intent(in) :: this
    is_listed_set = this%keyword == 'ELSET' .and. .not. this%has('GENERATE')
  end function is_listed_set

  !> Numbers of the elements, sorted.
  subroutine find_ids(cards, is_kept, ids)
    type(card), intent(in) :: cards(:)
    logical, intent(inout) :: is_kept(:)
    integer, allocatable, intent(out) :: ids(:)
    integer :: i, line, num
    allocate (ids(0))
    num = 0
    do i = 1, size(cards)
      if (.not. is_left_out(cards(i))) cycle
      is_kept(i) = .false.
      do line = 1, cards(i)%num_lines
        if (cards(i)%is_integer_at(line, 1)) call append(ids, num, cards(i)%integer_at(line, 1))
      end do
    end do
    ids = sorted_unique(ids(:num))
  end subroutine find_ids

  !> Puts another member of a set in place of such a number. A set without other members is not
  !> kept.
  subroutine shorten_set(this, ids, is_kept)
    type(card), intent(inout) :: this
    integer, intent(in) :: ids(:)
    logical, intent(inout) :: is_kept
    type(card_rewriter) :: words
    character(:), allocatable :: other
    integer :: line, field
    if (.not. names_any(this, ids)) return
    other = another_member(this, ids)
    is_kept = len(other) > 0
    if (.not. is_kept) return
    call words%begin(this)
    do line = 1, this%num_lines
      do field = 1, this%num_fields(line)
        if (is_out(this, line, field, ids)) call words%put_field(this, line, field, other)
      end do
    end do
    call words%finish(this)
  end subroutine shorten_set

  !> Whether a set holds the number of such an element.
  logical function names_any(this, ids)
    type(card), intent(in) :: this
    integer, intent(in) :: ids(:)
    integer :: line, field
    names_any = .false.
    do line = 1, this%num_lines
      names_any = names_any .or. &
                  any([(is_out(this, line, field, ids), field=1, this%num_fields(line))])
    end do
  end function names_any

  !> The last member of a set that is not the number of such an element; '' where none is left.
  function another_member(this, ids) result(other)
    type(card), intent(in) :: this
    integer, intent(in) :: ids(:)
    character(:), allocatable :: other
    integer :: line, field
    other = ''
    do line = 1, this%num_lines
      do field = 1, this%num_fields(line)
        if (this%is_empty_at(line, field)) cycle
        if (.not. is_out(this, line, field, ids)) other = this%text_at(line, field)
      end do
    end do
  end function another_member

  !> Whether a field is the number of an element that is left out.
  logical function is_out(this, line, field, ids)
    type(card), intent(in) :: this
    integer, intent(in) :: line, field, ids(:)
    is_out = this%is_integer_at(line, field)
    if (is_out) is_out = contains_position(ids, this%integer_at(line, field))
  end function is_out

  !> The cards that are kept.
  function pack_cards(cards, is_kept) result(kept)
    type(card), intent(in) :: cards(:)
    logical, intent(in) :: is_kept(:)
    type(card), allocatable :: kept(:)
    integer :: i, n
    allocate (kept(count(is_kept)))
    n = 0
    do i = 1, size(cards)
      if (.not. is_kept(i)) cycle
      n = n + 1
      kept(n) = cards(i)
    end do
  end function pack_cards
end module leave_out_faces
