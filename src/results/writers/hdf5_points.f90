!> Integration points of inelastic solids in job.h5: who they are, once; what those that have left
!> elasticity are in, with every increment. Points that are elastic are not written: their stress is
!> D eps, their history nil.
module hdf5_points
  use kinds, only: rk
  use problem_definition, only: problem
  use analysis_state, only: state
  use law_fields, only: width_of_field
  use requested_fields, only: components_of
  use hdf5_files, only: hdf5_file
  implicit none
  private
  public :: write_points, add_points

  !> Fields that live at points.
  character(8), parameter :: known(6) = ['S       ', 'E       ', 'PE      ', 'DAMAGET ', &
                                         'DAMAGEC ', 'SDV     ']

contains

  !> All points, block by block; nothing where there are none.
  subroutine write_points(file, scene)
    type(hdf5_file), intent(inout) :: file
    type(problem), intent(in) :: scene
    integer, allocatable :: element(:), number(:), material(:)
    real(rk), allocatable :: x(:, :), volume(:)
    integer :: i, before, n
    if (.not. allocated(scene%inelastic)) return
    if (size(scene%inelastic) == 0) return
    n = count_points(scene)
    allocate (element(n), number(n), material(n), x(3, n), volume(n))
    before = 0
    do i = 1, size(scene%inelastic)
      associate (points => scene%inelastic(i)%points)
        n = points%num_points
        element(before + 1:before + n) = points%element
        number(before + 1:before + n) = points%number
        material(before + 1:before + n) = scene%inelastic(i)%material - 1
        x(:, before + 1:before + n) = points%x
        volume(before + 1:before + n) = reshape(scene%inelastic(i)%weight, [n])
        before = before + n
      end associate
    end do
    call file%make_group('/points')
    call file%put('/points/element', element)
    call file%put('/points/number', number)
    call file%put('/points/material', material)
    call file%put('/points/x', x)
    call file%put('/points/volume', volume)
  end subroutine write_points

  !> Points of all blocks.
  pure integer function count_points(scene) result(total)
    type(problem), intent(in) :: scene
    integer :: i
    total = 0
    do i = 1, size(scene%inelastic)
      total = total + scene%inelastic(i)%points%num_points
    end do
  end function count_points

  !> The group `points` of an increment: rows of /points, and the fields that were asked for there.
  subroutine add_points(file, scene, now, fields, group)
    type(hdf5_file), intent(inout) :: file
    type(problem), intent(in) :: scene
    type(state), intent(in) :: now
    character(8), intent(in) :: fields(:)
    character(*), intent(in) :: group !< of the increment
    real(rk), allocatable :: values(:, :)
    integer, allocatable :: rows(:)
    integer :: i
    if (.not. allocated(scene%inelastic)) return
    if (size(scene%inelastic) == 0) return
    if (.not. any([(any(known == fields(i)), i=1, size(fields))])) return
    call list_rows(now, rows)
    call file%make_group(group//'/points')
    call file%put(group//'/points/row', rows - 1)
    do i = 1, size(fields)
      if (.not. any(known == fields(i))) cycle
      call gather(scene, now, fields(i), size(rows), values)
      associate (path => group//'/points/'//trim(fields(i)))
        if (size(values, 1) == 1) then
          call file%put(path, values(1, :))
        else
          call file%put(path, values)
          call file%set(path, 'components', components_of(fields(i), size(values, 1)))
        end if
      end associate
    end do
  end subroutine add_points

  !> Positions of the points that have left elasticity.
  subroutine list_rows(now, rows)
    type(state), intent(in) :: now
    integer, allocatable, intent(out) :: rows(:)
    integer :: i, p, row, last
    allocate (rows(sum([(count(.not. now%points(i)%is_elastic), i=1, size(now%points))])))
    row = 0
    last = 0
    do i = 1, size(now%points)
      do p = 1, size(now%points(i)%is_elastic)
        row = row + 1
        if (now%points(i)%is_elastic(p)) cycle
        last = last + 1
        rows(last) = row
      end do
    end do
  end subroutine list_rows

  !> A field at those points.
  subroutine gather(scene, now, name, num_rows, values)
    type(problem), intent(in) :: scene
    type(state), intent(in) :: now
    character(*), intent(in) :: name
    integer, intent(in) :: num_rows
    real(rk), allocatable, intent(out) :: values(:, :) !< (components, rows)
    real(rk), allocatable :: of_block(:, :)
    integer :: i, p, row, width
    width = 6
    if (name /= 'S' .and. name /= 'E') width = width_of_field(scene, name)
    allocate (values(width, num_rows), source=0.0_rk)
    row = 0
    do i = 1, size(now%points)
      if (all(now%points(i)%is_elastic)) cycle
      call read_block(scene, now, i, name, of_block)
      do p = 1, size(now%points(i)%is_elastic)
        if (now%points(i)%is_elastic(p)) cycle
        row = row + 1
        if (allocated(of_block)) values(:size(of_block, 1), row) = of_block(:, p)
      end do
    end do
  end subroutine gather

  !> A field at all points of a block; unallocated where the law does not have it.
  subroutine read_block(scene, now, block, name, values)
    type(problem), intent(in) :: scene
    type(state), intent(in) :: now
    integer, intent(in) :: block !< position in the problem's list
    character(*), intent(in) :: name
    real(rk), allocatable, intent(out) :: values(:, :) !< (components, points)
    select case (name)
    case ('S')
      values = now%points(block)%stress
    case ('E')
      values = now%points(block)%strain
    case default
      associate (law => scene%materials(scene%inelastic(block)%material)%law)
        call law%read_field(name, now%points(block), values)
      end associate
    end select
  end subroutine read_block
end module hdf5_points
