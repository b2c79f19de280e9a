!> Checks of joints, ties and interfaces: elements that belong to none of them, parts of faces
!> without a partner, faces that two joints cover.
module cover_checks
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use kinds, only: rk
  use mesh_faces, only: face_table, find_face, insert_face, open_table
  use model_draft, only: draft
  use surface_segments, only: facet_set, named_cover, surface_cover
  use write_text, only: as_text
  implicit none
  private
  public :: report_bare, keep_cover, claims, open_claims, claim_facets

  !> Bare parts up to this fraction of a face are not reported: nodes written with five digits cause
  !> them at the rim.
  real(rk), parameter :: bare_part = 1.0e-4_rk

  !> Gaps and overlaps up to this fraction of the mean side of a facet are not reported: different
  !> meshes on one curved surface have them if a facet spans 5 degrees.
  real(rk), parameter :: gap_part = 0.01_rk

  !> Coordinates and distances below this fraction of the largest coordinate are zero.
  real(rk), parameter :: round_off = 1.0e-12_rk

  !> Two joints overlap if they cover a face together by more than this fraction beyond the whole.
  !> Faces that fit up to the rounding of the mesher stay below.
  real(rk), parameter :: most_cover = 1.01_rk

  type :: claims
    type(face_table) :: table
    integer, allocatable :: owner(:) !< (faces) the first joint that took the face
    real(rk), allocatable :: covered(:) !< (faces) fraction covered by all joints
  end type claims

contains

  !> Reports the first of the elements that lack something, and the number of others.
  subroutine report_bare(is_bare, lack, expected, model, faults)
    logical, intent(in) :: is_bare(:) !< (elements)
    character(*), intent(in) :: lack, expected
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    character(:), allocatable :: others
    integer :: e
    if (.not. any(is_bare)) return
    e = findloc(is_bare, .true., dim=1)
    others = ''
    if (count(is_bare) > 1) others = ', as '//as_text(count(is_bare) - 1)//' more'
    associate (spot => model%element_origin(e))
      call model%cards(spot%card)%fault_at(faults, spot%line, 1, 'element '// &
                                           as_text(model%problem%mesh%element_id(e))//' has '// &
                                           lack//others, expected)
    end associate
  end subroutine report_bare

  !> Stores how well two faces cover each other, and reports faults at the card of the interface: an
  !> error without any cover, warnings for parts without partner, gaps and overlaps.
  subroutine keep_cover(place, name, kind, cover, gaps_count, is_moved, model, faults)
    type(card), intent(in) :: place
    character(*), intent(in) :: name !< upper case
    character(*), intent(in) :: kind !< 'JOINT', 'TIE' or 'INTERFACE'
    type(surface_cover), intent(in) :: cover
    logical, intent(in) :: gaps_count !< gaps in the mesh are intended
    logical, intent(in) :: is_moved !< the faces are moved together
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(named_cover) :: new
    real(rk) :: side, bare, least
    character(:), allocatable :: afterwards
    new%name = name
    new%kind = kind
    new%cover = cover
    least = round_off*maxval(abs(model%problem%mesh%x))
    if (cover%largest_gap <= least) new%cover%largest_gap = 0.0_rk
    if (cover%largest_overlap <= least) new%cover%largest_overlap = 0.0_rk
    model%problem%covers = [model%problem%covers, new]
    if (cover%covered_area <= 0.0_rk) then
      call place%fault(faults, 'no facet of one face lies opposite a facet of the other', &
                       'faces that lie on each other, with opposite normals')
      return
    end if
    bare = cover%slave_area - cover%covered_area
    if (bare > bare_part*cover%slave_area) then
      call place%warn(faults, as_text(bare)//' of the area '//as_text(cover%slave_area)// &
                      ' of the slave face has no master facet opposite, most of it at '// &
                      place_text(cover%bare_place))
    end if
    if (cover%excess_area > bare_part*cover%slave_area) then
      call place%warn(faults, 'master facets overlap: '// &
                      as_text(cover%excess_area)//' of the area '// &
                      as_text(cover%slave_area)//' of the slave face is covered twice')
    end if
    side = sqrt(cover%slave_area/max(1, size(cover%bare)))
    afterwards = ''
    if (is_moved) afterwards = '; ADJUST=YES moves them together'
    if (cover%largest_gap > gap_part*side .and. .not. gaps_count) then
      call place%warn(faults, 'the faces lie up to '//as_text(cover%largest_gap)// &
                      ' apart, at '//place_text(cover%gap_place)//afterwards)
    end if
    if (cover%largest_overlap > gap_part*side) then
      call place%warn(faults, 'the faces overlap by up to '//as_text(cover%largest_overlap)// &
                      ', at '//place_text(cover%overlap_place)//afterwards)
    end if
  end subroutine keep_cover

  !> '(1, 2, 3)', without round-off.
  pure function place_text(x) result(text)
    real(rk), intent(in) :: x(3) !< [m]
    character(:), allocatable :: text
    real(rk) :: y(3)
    y = merge(x, 0.0_rk, abs(x) > round_off*maxval(abs(x)))
    text = '('//as_text(y(1))//', '//as_text(y(2))//', '//as_text(y(3))//')'
  end function place_text

  !> Starts with no face taken.
  pure subroutine open_claims(num_nodes, capacity, taken)
    integer, intent(in) :: num_nodes !< of the mesh
    integer, intent(in) :: capacity !< most faces
    type(claims), intent(out) :: taken
    call open_table(num_nodes, capacity, taken%table)
    allocate (taken%owner(capacity), source=0)
    allocate (taken%covered(capacity), source=0.0_rk)
  end subroutine open_claims

  !> Adds the slave facets of a joint, and returns the first one that another joint covers.
  pure subroutine claim_facets(taken, joint, slave, cover, facet, earlier)
    type(claims), intent(inout) :: taken
    integer, intent(in) :: joint
    type(facet_set), intent(in) :: slave
    type(surface_cover), intent(in) :: cover
    integer, intent(out) :: facet !< covered by an earlier joint, 0 for none
    integer, intent(out) :: earlier !< the earlier joint
    integer :: f, number
    facet = 0
    earlier = 0
    do f = 1, size(slave%element)
      if (cover%bare(f) >= 1.0_rk) cycle
      number = find_face(taken%table, slave%node(:, f))
      if (number == 0) then
        call insert_face(taken%table, slave%node(:, f), number)
        taken%owner(number) = joint
      end if
      taken%covered(number) = taken%covered(number) + 1.0_rk - cover%bare(f)
      if (facet > 0 .or. taken%covered(number) <= most_cover) cycle
      facet = f
      earlier = taken%owner(number)
    end do
  end subroutine claim_facets
end module cover_checks
