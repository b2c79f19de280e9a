!> How many solids lie behind each other around a place, through faces that they share.
module solid_layers
  implicit none
  private
  public :: has_three_layers

  integer, parameter :: enough = 3
  !> The corners of the face at the low end of each direction of a brick, then at the high end.
  integer, parameter :: face(4, 3, 2) = reshape([1, 4, 8, 5, 1, 2, 6, 5, 1, 2, 3, 4, &
                                                 2, 3, 7, 6, 4, 3, 7, 8, 5, 6, 7, 8], [4, 3, 2])

contains

  !> Whether three solids or more lie behind each other in each direction of a solid, or that solid
  !> alone: a stress does not vary across the one layer of a slice.
  pure logical function has_three_layers(patch, solids, start)
    integer, intent(in) :: patch(:, :) !< (8, all solids) of each corner; shared corners are equal
    integer, intent(in) :: solids(:) !< those that count
    integer, intent(in) :: start !< the solid
    integer :: direction, layers
    has_three_layers = .true.
    do direction = 1, 3
      layers = 1 + layers_behind(patch, solids, start, face(:, direction, 1)) &
               + layers_behind(patch, solids, start, face(:, direction, 2))
      has_three_layers = has_three_layers .and. (layers == 1 .or. layers >= enough)
    end do
  end function has_three_layers

  !> The number of solids behind a face of a solid, as far as it matters.
  pure integer function layers_behind(patch, solids, start, corners) result(layers)
    integer, intent(in) :: patch(:, :), solids(:), start
    integer, intent(in) :: corners(:) !< of the face
    integer, allocatable :: shared(:)
    integer :: own, next
    own = start
    shared = patch(corners, start)
    layers = 0
    do while (layers < enough - 1 .and. .not. is_edge(shared))
      next = solid_with(patch, solids, shared, own)
      if (next == 0) return
      layers = layers + 1
      own = next
      shared = pack(patch(:, own), [(.not. any(shared == patch(next, own)), next=1, 8)])
    end do
  end function layers_behind

  !> Whether these corners are fewer than three: of a wedge.
  pure logical function is_edge(corners)
    integer, intent(in) :: corners(:)
    integer :: i
    is_edge = count([(all(corners(:i - 1) /= corners(i)), i=1, size(corners))]) < 3
  end function is_edge

  !> The other solid that has these corners; 0 if there is none.
  pure integer function solid_with(patch, solids, corners, own)
    integer, intent(in) :: patch(:, :), solids(:), corners(:), own
    integer :: i, k
    solid_with = 0
    do k = 1, size(solids)
      if (solids(k) == own) cycle
      if (.not. all([(any(patch(:, solids(k)) == corners(i)), i=1, size(corners))])) cycle
      solid_with = solids(k)
      return
    end do
  end function solid_with
end module solid_layers
