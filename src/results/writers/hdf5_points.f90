!> Integration points of inelastic solids in job.h5: the list of points once, and the fields of
!> points that have left elasticity in every increment. Elastic points are not written: their stress
!> is D eps, their state variables are zero.
module hdf5_points
  use kinds, only: rk
  use problem_definition, only: problem
  use analysis_state, only: state
  use field_type, only: result_field
  use hdf5_fields, only: put_field
  use hdf5_files, only: hdf5_file
  implicit none
  private
  public :: write_points, add_points

contains

  !> Writes the list of points, block by block; no group without points.
  subroutine write_points(file, model)
    type(hdf5_file), intent(inout) :: file
    type(problem), intent(in) :: model
    integer, allocatable :: element(:), number(:), material(:)
    real(rk), allocatable :: x(:, :), volume(:)
    integer :: i, before, n
    if (.not. allocated(model%inelastic)) return
    if (size(model%inelastic) == 0) return
    n = count_points(model)
    allocate (element(n), number(n), material(n), x(3, n), volume(n))
    before = 0
    do i = 1, size(model%inelastic)
      associate (points => model%inelastic(i)%points)
        n = points%num_points
        element(before + 1:before + n) = points%element
        number(before + 1:before + n) = points%number
        material(before + 1:before + n) = model%inelastic(i)%material - 1
        x(:, before + 1:before + n) = points%x
        volume(before + 1:before + n) = reshape(model%inelastic(i)%weight, [n])
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
  pure integer function count_points(model) result(total)
    type(problem), intent(in) :: model
    integer :: i
    total = 0
    do i = 1, size(model%inelastic)
      total = total + model%inelastic(i)%points%num_points
    end do
  end function count_points

  !> The group `points` of an increment: rows of /points, and the requested fields.
  subroutine add_points(file, model, now, fields, group)
    type(hdf5_file), intent(inout) :: file
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(result_field), intent(in) :: fields(:) !< requested now
    character(*), intent(in) :: group !< of the increment
    real(rk), allocatable :: values(:, :)
    integer, allocatable :: rows(:)
    integer :: i
    if (.not. allocated(model%inelastic)) return
    if (size(model%inelastic) == 0) return
    if (.not. any([(associated(fields(i)%of_block), i=1, size(fields))])) return
    call list_rows(now, rows)
    call file%make_group(group//'/points')
    call file%put(group//'/points/row', rows - 1)
    do i = 1, size(fields)
      if (.not. associated(fields(i)%of_block)) cycle
      call gather(model, now, fields(i), size(rows), values)
      call put_field(file, group//'/points/'//fields(i)%name, values, &
                     fields(i)%components(size(values, 1)))
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

  !> A field at the points that have left elasticity.
  subroutine gather(model, now, item, num_rows, values)
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(result_field), intent(in) :: item
    integer, intent(in) :: num_rows
    real(rk), allocatable, intent(out) :: values(:, :) !< (components, rows)
    real(rk), allocatable :: of_block(:, :)
    integer :: i, p, row
    allocate (values(item%width(model), num_rows), source=0.0_rk)
    row = 0
    do i = 1, size(now%points)
      if (all(now%points(i)%is_elastic)) cycle
      call item%of_block(model, now, i, of_block)
      do p = 1, size(now%points(i)%is_elastic)
        if (now%points(i)%is_elastic(p)) cycle
        row = row + 1
        if (allocated(of_block)) values(:size(of_block, 1), row) = of_block(:, p)
      end do
    end do
  end subroutine gather
end module hdf5_points
