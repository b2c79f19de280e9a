!> Tells how well two faces cover each other: an error where they do not at all, warnings where a
!> part has no partner or the faces lie apart. The numbers stay with the problem.
module tell_cover
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use kinds, only: rk
  use model_draft, only: draft
  use surface_segments, only: named_cover, surface_cover
  use write_text, only: as_text
  implicit none
  private
  public :: keep_cover

  !> Bare parts of a face up to this part of it are not told: rims whose nodes are written with
  !> five digits.
  real(rk), parameter :: bare_part = 1.0e-4_rk

  !> Gaps and overlaps up to this part of a mean facet's side are not told: faces of different
  !> meshes on one curved surface lie so far apart when a facet turns by 5 degrees.
  real(rk), parameter :: gap_part = 0.01_rk

  !> Coordinates and distances below this part of the largest coordinate are zero.
  real(rk), parameter :: round_off = 1.0e-12_rk

contains

  !> Keeps the cover of an interface and tells its faults at the card of the interface.
  subroutine keep_cover(place, name, kind, cover, gaps_count, model, faults)
    type(card), intent(in) :: place
    character(*), intent(in) :: name !< upper case
    character(*), intent(in) :: kind !< 'JOINT', 'TIE' or 'INTERFACE'
    type(surface_cover), intent(in) :: cover
    logical, intent(in) :: gaps_count !< gaps between the faces as meshed are meant
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(named_cover) :: new
    real(rk) :: side, bare, least
    new%name = name
    new%kind = kind
    new%cover = cover
    least = round_off*maxval(abs(model%scene%mesh%x))
    if (cover%largest_gap <= least) new%cover%largest_gap = 0.0_rk
    if (cover%largest_overlap <= least) new%cover%largest_overlap = 0.0_rk
    model%scene%covers = [model%scene%covers, new]
    if (cover%covered_area <= 0.0_rk) then
      call place%fault(faults, 'no facet of one face lies opposite a facet of the other', &
                       'faces that lie on each other and look against each other')
      return
    end if
    bare = cover%slave_area - cover%covered_area
    if (bare > bare_part*cover%slave_area) then
      call place%warn(faults, as_text(bare)//' of the '//as_text(cover%slave_area)// &
                      ' m2 of the slave face have no master facet opposite, most of it at '// &
                      place_text(cover%bare_place))
    end if
    if (cover%excess_area > bare_part*cover%slave_area) then
      call place%warn(faults, 'master facets lie upon each other: '// &
                      as_text(cover%excess_area)//' of the '//as_text(cover%slave_area)// &
                      ' m2 of the slave face count twice')
    end if
    side = sqrt(cover%slave_area/max(1, size(cover%bare)))
    if (cover%largest_gap > gap_part*side .and. .not. gaps_count) then
      call place%warn(faults, 'the faces lie up to '//as_text(cover%largest_gap)// &
                      ' m apart, at '//place_text(cover%gap_place))
    end if
    if (cover%largest_overlap > gap_part*side) then
      call place%warn(faults, 'the faces overlap by up to '//as_text(cover%largest_overlap)// &
                      ' m, at '//place_text(cover%overlap_place))
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
end module tell_cover
