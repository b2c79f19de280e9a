!> Twins of points of inelastic solids, which take the increments in two halves beside the run: what
!> they differ by from their points shows the error of the law within increments (theory.md, 14.7).
module path_twins
  use archive_type, only: archive
  use material_points, only: point_state
  use write_text, only: as_text
  implicit none
  private
  public :: twin_points, gather_points, save_twins, load_twins

  !> The twins of the points of one material. A new component gets a line in save and load.
  type :: twin_points
    integer, allocatable :: block(:) !< (twins) of inelastic solids in the problem
    integer, allocatable :: point(:) !< (twins) in the block
    type(point_state) :: at !< of the twins
  contains
    procedure :: num_twins, add, keep
  end type twin_points

contains

  !> Number of twins.
  pure integer function num_twins(self)
    class(twin_points), intent(in) :: self
    num_twins = 0
    if (allocated(self%point)) num_twins = size(self%point)
  end function num_twins

  !> Adds twins that start from the states of their points.
  subroutine add(self, states, block, point)
    class(twin_points), intent(inout) :: self
    type(point_state), intent(in) :: states(:) !< (blocks)
    integer, intent(in) :: block(:), point(:)
    type(point_state) :: both(2), all
    integer :: i, n
    if (size(point) == 0) return
    n = self%num_twins()
    call gather_points(states, block, point, both(2))
    if (n == 0) then
      self%block = block
      self%point = point
      self%at = both(2)
      return
    end if
    both(1) = self%at
    call gather_points(both, [spread(1, 1, n), spread(2, 1, size(point))], &
                       [(i, i=1, n), (i, i=1, size(point))], all)
    self%block = [self%block, block]
    self%point = [self%point, point]
    self%at = all
  end subroutine add

  !> Keeps some twins and forgets the others.
  subroutine keep(self, is_kept)
    class(twin_points), intent(inout) :: self
    logical, intent(in) :: is_kept(:) !< (twins)
    type(point_state) :: kept
    integer :: i
    if (all(is_kept)) return
    call gather_points([self%at], spread(1, 1, count(is_kept)), &
                       pack([(i, i=1, size(is_kept))], is_kept), kept)
    self%block = pack(self%block, is_kept)
    self%point = pack(self%point, is_kept)
    self%at = kept
  end subroutine keep

  !> The states of some points, which may be in different blocks of one material.
  subroutine gather_points(states, block, point, own)
    type(point_state), intent(in) :: states(:) !< (blocks)
    integer, intent(in) :: block(:), point(:)
    type(point_state), intent(out) :: own
    integer :: i
    if (size(block) == 0) return
    call open_points(states(block(1)), size(block), own)
    do i = 1, size(block)
      call copy_point(states(block(i)), point(i), i, own)
    end do
  end subroutine gather_points

  !> Room for points of one kind.
  subroutine open_points(like, n, own)
    type(point_state), intent(in) :: like
    integer, intent(in) :: n !< points
    type(point_state), intent(inout) :: own
    allocate (own%strain(6, n), own%stress(6, n), own%internal(size(like%internal, 1), n), &
              own%energy(size(like%energy, 1), n), own%is_elastic(n))
    allocate (own%gradient(3, 3, merge(n, 0, size(like%gradient, 3) > 0)))
    if (allocated(like%temperature)) allocate (own%temperature(n))
    if (allocated(like%thermal)) allocate (own%thermal(6, n))
  end subroutine open_points

  !> Copies the state of one point.
  pure subroutine copy_point(from, p, q, to)
    type(point_state), intent(in) :: from
    integer, intent(in) :: p, q !< the point, and its place in `to`
    type(point_state), intent(inout) :: to
    to%strain(:, q) = from%strain(:, p)
    to%stress(:, q) = from%stress(:, p)
    to%internal(:, q) = from%internal(:, p)
    to%energy(:, q) = from%energy(:, p)
    to%is_elastic(q) = from%is_elastic(p)
    if (size(to%gradient, 3) > 0) to%gradient(:, :, q) = from%gradient(:, :, p)
    if (allocated(to%temperature)) to%temperature(q) = from%temperature(p)
    if (allocated(to%thermal)) to%thermal(:, q) = from%thermal(:, p)
  end subroutine copy_point

  !> Writes the twins of all materials.
  subroutine save_twins(twins, file)
    type(twin_points), allocatable, intent(in) :: twins(:)
    class(archive), intent(inout) :: file
    integer :: i, num_lists
    num_lists = 0
    if (allocated(twins)) num_lists = size(twins)
    call file%put('num_twin_lists', num_lists)
    do i = 1, num_lists
      call file%open_group('twins_'//as_text(i))
      call save_list(twins(i), file)
      call file%close_group()
    end do
  end subroutine save_twins

  !> Reads them.
  subroutine load_twins(twins, file)
    type(twin_points), allocatable, intent(inout) :: twins(:)
    class(archive), intent(inout) :: file
    integer :: i, num_lists
    num_lists = 0
    call file%get('num_twin_lists', num_lists)
    if (allocated(twins)) deallocate (twins)
    if (num_lists == 0) return
    allocate (twins(num_lists))
    do i = 1, num_lists
      call file%open_group('twins_'//as_text(i))
      call load_list(twins(i), file)
      call file%close_group()
    end do
  end subroutine load_twins

  !> Writes the twins of one material into the present group.
  subroutine save_list(twins, file)
    type(twin_points), intent(in) :: twins
    class(archive), intent(inout) :: file
    call file%put('block', twins%block)
    call file%put('point', twins%point)
    call twins%at%save(file)
  end subroutine save_list

  !> Reads the twins of one material from the present group.
  subroutine load_list(twins, file)
    type(twin_points), intent(inout) :: twins
    class(archive), intent(inout) :: file
    call file%get('block', twins%block)
    call file%get('point', twins%point)
    call twins%at%load(file)
  end subroutine load_list
end module path_twins
