!> Saves and loads the points of a material. Every component of `point_state` has a line in each of
!> the two procedures; tests/tools/test_archives.py compares them with the type.
module point_archive
  use archive_type, only: archive
  use material_points, only: point_state
  implicit none
  private
  public :: save_points, load_points

contains

  !> Writes the points of one block into the present group.
  subroutine save_points(points, file)
    type(point_state), intent(in) :: points
    class(archive), intent(inout) :: file
    call file%put('strain', points%strain)
    call file%put('stress', points%stress)
    call file%put('internal', points%internal)
    call file%put('energy', points%energy)
    call file%put('gradient', points%gradient)
    call file%put('is_elastic', points%is_elastic)
  end subroutine save_points

  !> Reads the points of one block from the present group. The points must be in their initial
  !> state, which fixes the sizes.
  subroutine load_points(points, file)
    type(point_state), intent(inout) :: points
    class(archive), intent(inout) :: file
    call file%get('strain', points%strain)
    call file%get('stress', points%stress)
    call file%get('internal', points%internal)
    call file%get('energy', points%energy)
    call file%get('gradient', points%gradient)
    call file%get('is_elastic', points%is_elastic)
  end subroutine load_points
end module point_archive
