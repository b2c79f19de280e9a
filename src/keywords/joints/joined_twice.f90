!> Refuses faces that two ties or joints join: their stiffnesses would add up, or one of them would
!> have no effect.
!>
!> A face may belong to several ties and joints with different partners. Two opposite facets may not
!> belong to the same two ties or joints, for any choice of slave and any names of surfaces.
module joined_twice
  use dam_mesh, only: fe_mesh, surface
  use diagnostics, only: diagnostic_list
  use facet_segments, only: find_segments
  use finish_joints, only: farthest_gap, farthest_contact
  use kinds, only: rk
  use model_draft, only: draft, origin
  use surface_facets, only: list_surface_facets
  use surface_segments, only: facet_set, segment_set, surface_cover
  implicit none
  private
  public :: refuse_joined_twice

  !> Facets opposite by less than this fraction are neighbours of partners, from the rounding of a
  !> mesher.
  real(rk), parameter :: sliver = 0.01_rk

  !> Two surfaces that a tie or a joint joins.
  type :: pair
    character(:), allocatable :: name !< with its kind: "tie 'T'"
    integer :: surfaces(2) = 0 !< slave and master, positions
    real(rk) :: farthest = farthest_contact !< largest distance, in diagonals of a facet
    type(origin) :: spot
  end type pair

  !> The pairs of each face of an element, as linked lists.
  type :: face_book
    integer :: used = 0
    integer, allocatable :: first(:, :) !< (6, elements) newest entry, 0 for none
    integer, allocatable :: next(:) !< (entries) next of the same face, 0 at the end
    integer, allocatable :: pair(:), side(:) !< (entries)
  end type face_book

contains

  !> Reports each tie or joint that joins the same facets as an earlier one of the deck.
  subroutine refuse_joined_twice(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(pair), allocatable :: pairs(:)
    type(face_book) :: book
    integer, allocatable :: meets(:, :, :)
    integer :: i, earlier, total
    call list_pairs(model, pairs)
    if (size(pairs) < 2) return
    total = 0
    do i = 1, size(pairs)
      total = total + size(model%problem%surfaces(pairs(i)%surfaces(1))%element) &
              + size(model%problem%surfaces(pairs(i)%surfaces(2))%element)
    end do
    allocate (book%first(6, model%problem%mesh%num_elements), source=0)
    allocate (book%next(total), book%pair(total), book%side(total), source=0)
    allocate (meets(2, 2, size(pairs)), source=0)
    do i = 1, size(pairs)
      call find_earlier(i, pairs, model, book, meets, earlier)
      call enter_faces(i, 1, model%problem%surfaces(pairs(i)%surfaces(1)), book)
      call enter_faces(i, 2, model%problem%surfaces(pairs(i)%surfaces(2)), book)
      if (earlier == 0) cycle
      call model%cards(pairs(i)%spot%card)%fault_at( &
        faults, pairs(i)%spot%line, 1, 'the faces are joined by '//pairs(earlier)%name// &
        ' already', 'one tie or joint for two faces', &
        first=model%cards(pairs(earlier)%spot%card)%place())
    end do
  end subroutine refuse_joined_twice

  !> Ties and joints between surfaces in the order of the deck.
  subroutine list_pairs(model, pairs)
    type(draft), intent(in) :: model
    type(pair), allocatable, intent(out) :: pairs(:)
    integer :: t, j, used
    logical :: takes_tie
    allocate (pairs(size(model%ties) + count(model%joints%slave > 0)))
    t = 1
    j = 1
    do used = 1, size(pairs)
      do while (j <= size(model%joints))
        if (model%joints(j)%slave > 0) exit
        j = j + 1
      end do
      takes_tie = j > size(model%joints)
      if (t <= size(model%ties) .and. .not. takes_tie) then
        takes_tie = model%ties(t)%spot%card < model%joints(j)%spot%card
      end if
      if (takes_tie) then
        pairs(used)%name = "tie '"//model%ties(t)%name//"'"
        pairs(used)%surfaces = [model%ties(t)%slave, model%ties(t)%master]
        pairs(used)%spot = model%ties(t)%spot
        t = t + 1
      else
        pairs(used)%name = "joint '"//model%joints(j)%name//"'"
        pairs(used)%surfaces = [model%joints(j)%slave, model%joints(j)%master]
        if (model%joints(j)%is_measured) pairs(used)%farthest = farthest_gap
        pairs(used)%spot = origin(model%joints(j)%spot%card, max(1, model%joints(j)%spot%line))
        j = j + 1
      end if
    end do
  end subroutine list_pairs

  !> The first earlier pair that joins facets of pair `new`, 0 for none.
  subroutine find_earlier(new, pairs, model, book, meets, earlier)
    integer, intent(in) :: new
    type(pair), intent(in) :: pairs(:)
    type(draft), intent(in) :: model
    type(face_book), intent(in) :: book
    integer, intent(inout) :: meets(:, :, :) !< (side of the newer pair, side of this one, pairs)
    !< the newest pair that shares a face
    integer, intent(out) :: earlier
    integer :: side, k, entry, p
    do side = 1, 2
      associate (faces => model%problem%surfaces(pairs(new)%surfaces(side)))
        do k = 1, size(faces%element)
          entry = book%first(faces%face(k), faces%element(k))
          do while (entry > 0)
            meets(side, book%side(entry), book%pair(entry)) = new
            entry = book%next(entry)
          end do
        end do
      end associate
    end do
    do p = 1, new - 1
      do side = 1, 2
        if (meets(1, side, p) /= new .or. meets(2, 3 - side, p) /= new) cycle
        earlier = p
        if (join_the_same(pairs(new), pairs(p), p, side, model, book)) return
      end do
    end do
    earlier = 0
  end subroutine find_earlier

  !> Whether faces shared by two pairs lie opposite each other.
  logical function join_the_same(new, old, number, side, model, book)
    type(pair), intent(in) :: new, old
    integer, intent(in) :: number !< of the old pair
    integer, intent(in) :: side !< of the old pair where the new one has its slave
    type(draft), intent(in) :: model
    type(face_book), intent(in) :: book
    type(facet_set) :: slave, master
    type(segment_set) :: segments
    type(surface_cover) :: cover
    associate (problem => model%problem)
      call list_shared(problem%mesh, problem%surfaces(new%surfaces(1)), number, side, book, slave)
      call list_shared(problem%mesh, problem%surfaces(new%surfaces(2)), number, 3 - side, book, &
                       master)
      call find_segments(problem%mesh%x, slave, master, segments, cover, &
                         min(new%farthest, old%farthest))
    end associate
    join_the_same = any(cover%bare < 1.0_rk - sliver) &
                    .or. cover%covered_area > sliver*cover%master_area
  end function join_the_same

  !> Facets of a surface on one side of a pair.
  pure subroutine list_shared(mesh, faces, number, side, book, facets)
    type(fe_mesh), intent(in) :: mesh
    type(surface), intent(in) :: faces
    integer, intent(in) :: number, side !< of the pair
    type(face_book), intent(in) :: book
    type(facet_set), intent(out) :: facets
    type(surface) :: shared
    logical :: is_shared(size(faces%element))
    integer :: k, entry
    is_shared = .false.
    do k = 1, size(faces%element)
      entry = book%first(faces%face(k), faces%element(k))
      do while (entry > 0 .and. .not. is_shared(k))
        is_shared(k) = book%pair(entry) == number .and. book%side(entry) == side
        entry = book%next(entry)
      end do
    end do
    shared%element = pack(faces%element, is_shared)
    shared%face = pack(faces%face, is_shared)
    call list_surface_facets(mesh, shared, facets)
  end subroutine list_shared

  !> Stores the pair of each face.
  pure subroutine enter_faces(number, side, faces, book)
    integer, intent(in) :: number, side !< of the pair
    type(surface), intent(in) :: faces
    type(face_book), intent(inout) :: book
    integer :: k
    do k = 1, size(faces%element)
      book%used = book%used + 1
      book%pair(book%used) = number
      book%side(book%used) = side
      book%next(book%used) = book%first(faces%face(k), faces%element(k))
      book%first(faces%face(k), faces%element(k)) = book%used
    end do
  end subroutine enter_faces
end module joined_twice
