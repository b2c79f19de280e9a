!> Columns and rows of the CSV histories.
module history_rows
  use kinds, only: rk
  use problem_definition, only: problem
  use analysis_state, only: state
  use field_type, only: result_field
  use run_records, only: run_record
  use print_kinds, only: print_kind, kinds_of_prints, prints_of_nodes, prints_of_elements, &
                         prints_of_joints
  use csv_files, only: csv_file
  use json_writer, only: lower
  use text_buffers, only: text_buffer
  implicit none
  private
  public :: history_file, header_of, add_rows

  !> One file. The columns are the fields of all steps.
  type, extends(csv_file) :: history_file
    integer :: kind = 0 !< position in `kinds_of_prints`
    character(:), allocatable :: name !< of the set or joint
    integer, allocatable :: fields(:) !< rows of the record's table
    integer :: joint = 0 !< position of the joint, 0 for other kinds
  end type history_file

  !> A field at the points of some solids.
  type :: point_values
    real(rk), allocatable :: at(:, :, :) !< (components, max_points, solids)
  end type point_values

  !> A field on all nodes, or at all points of a joint; unallocated where it is zero.
  type :: list_values
    real(rk), allocatable :: at(:, :) !< (components, nodes or points)
  end type list_values

contains

  !> The header line.
  function header_of(model, table, kind, fields) result(header)
    type(problem), intent(in) :: model
    type(result_field), intent(in) :: table(:) !< all fields
    type(print_kind), intent(in) :: kind
    integer, intent(in) :: fields(:) !< rows of the table, in the order of the request
    character(:), allocatable :: header
    integer :: i
    header = 'step,increment,time,'//trim(kind%columns)
    if (kind%has_all_fields) then
      do i = 1, size(table)
        if (.not. table(i)%is_allowed_in(trim(kind%keyword))) cycle
        header = header//','//lower(table(i)%columns(table(i)%width(model)))
      end do
      return
    end if
    do i = 1, size(fields)
      header = header//','//table(fields(i))%columns(table(fields(i))%width(model))
    end do
  end function header_of

  !> The rows of chosen nodes, elements or points of a joint.
  subroutine add_rows(file, model, now, record, chosen)
    type(history_file), intent(inout) :: file
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(run_record), intent(inout) :: record
    integer, intent(in) :: chosen(:)
    select case (file%kind)
    case (prints_of_nodes)
      call add_node_rows(file%lines, model, now, record, file%fields, chosen)
    case (prints_of_elements)
      call add_element_rows(file%lines, model, now, record, file%fields, chosen)
    case default
      call add_joint_rows(file%lines, model, now, record, file%joint, chosen)
    end select
  end subroutine add_rows

  !> Step, increment and total time.
  subroutine add_time(lines, now)
    type(text_buffer), intent(inout) :: lines
    type(state), intent(in) :: now
    call lines%add_integer(now%step)
    call lines%add(',')
    call lines%add_integer(now%increment)
    call lines%add(',')
    call lines%add_real(now%total_time)
  end subroutine add_time

  !> Reals, each after a comma.
  subroutine add_reals(lines, numbers)
    type(text_buffer), intent(inout) :: lines
    real(rk), intent(in) :: numbers(:)
    integer :: i
    do i = 1, size(numbers)
      call lines%add(',')
      call lines%add_real(numbers(i))
    end do
  end subroutine add_reals

  !> One row for each node; a field that the step does not have is zero.
  subroutine add_node_rows(lines, model, now, record, fields, nodes)
    type(text_buffer), intent(inout) :: lines
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(run_record), intent(inout) :: record
    integer, intent(in) :: fields(:) !< rows of the record's table
    integer, intent(in) :: nodes(:) !< positions
    type(list_values) :: values(size(fields))
    integer :: k, i
    do i = 1, size(fields)
      associate (item => record%fields(fields(i)))
        call item%on_nodes(model, now, record%stresses, values(i)%at)
        if (.not. allocated(values(i)%at)) then
          allocate (values(i)%at(item%width(model), model%mesh%num_nodes), source=0.0_rk)
        end if
      end associate
    end do
    do k = 1, size(nodes)
      call add_time(lines, now)
      call lines%add(',')
      call lines%add_integer(model%mesh%node_id(nodes(k)))
      do i = 1, size(fields)
        call add_reals(lines, values(i)%at(:, nodes(k)))
      end do
      call lines%add(new_line('a'))
    end do
  end subroutine add_node_rows

  !> One row for each integration point of each solid; other elements have no points.
  subroutine add_element_rows(lines, model, now, record, fields, elements)
    type(text_buffer), intent(inout) :: lines
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(run_record), intent(inout) :: record
    integer, intent(in) :: fields(:) !< rows of the record's table
    integer, intent(in) :: elements(:) !< positions
    type(point_values) :: values(size(fields))
    integer, allocatable :: chosen(:), solids(:)
    integer :: k, q, i
    call record%stresses%need_plan(model)
    associate (plan => record%stresses%plan)
      chosen = pack(elements, plan%solid_of_element(elements) > 0)
      solids = plan%solid_of_element(chosen)
      do i = 1, size(fields)
        call record%fields(fields(i))%of_solids(model, now, record%stresses, solids, values(i)%at)
      end do
      do k = 1, size(chosen)
        do q = 1, plan%num_points(solids(k))
          call add_time(lines, now)
          call lines%add(',')
          call lines%add_integer(model%mesh%element_id(chosen(k)))
          call lines%add(',')
          call lines%add_integer(q)
          do i = 1, size(fields)
            call add_reals(lines, values(i)%at(:, q, k))
          end do
          call lines%add(new_line('a'))
        end do
      end do
    end associate
  end subroutine add_element_rows

  !> One row for each chosen point of a joint, with all printed fields of joints.
  subroutine add_joint_rows(lines, model, now, record, joint, points)
    type(text_buffer), intent(inout) :: lines
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(run_record), intent(in) :: record
    integer, intent(in) :: joint !< position in the problem
    integer, intent(in) :: points(:)
    type(list_values) :: values(size(record%fields))
    character(:), allocatable :: keyword
    integer :: k, p, i
    keyword = trim(kinds_of_prints(prints_of_joints)%keyword)
    do i = 1, size(record%fields)
      if (.not. record%fields(i)%is_allowed_in(keyword)) cycle
      call record%fields(i)%of_joint(model, now, joint, values(i)%at)
    end do
    do k = 1, size(points)
      p = points(k)
      call add_time(lines, now)
      call lines%add(',')
      call lines%add_integer(p)
      call add_reals(lines, model%joints(joint)%x(:, p))
      do i = 1, size(values)
        if (.not. allocated(values(i)%at)) cycle
        if (record%fields(i)%is_integer) then
          call lines%add(',')
          call lines%add_integer(nint(values(i)%at(1, p)))
        else
          call add_reals(lines, values(i)%at(:, p))
        end if
      end do
      call lines%add(new_line('a'))
    end do
  end subroutine add_joint_rows
end module history_rows
