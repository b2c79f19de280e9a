!> Columns and rows of the CSV histories.
module history_rows
  use kinds, only: rk
  use problem_definition, only: problem
  use analysis_state, only: state
  use field_type, only: result_field
  use run_records, only: run_record
  use json_writer, only: lower
  use text_buffers, only: text_buffer
  implicit none
  private
  public :: name_part, keyword_of, header_of
  public :: add_node_rows, add_element_rows, add_joint_rows

  !> A field at the points of some solids.
  type :: point_values
    real(rk), allocatable :: at(:, :, :) !< (components, max_points, solids)
  end type point_values

  !> A field on all nodes, or at all points of a joint; unallocated where it is zero.
  type :: list_values
    real(rk), allocatable :: at(:, :) !< (components, nodes or points)
  end type list_values

contains

  !> Part of the file name.
  pure function name_part(kind) result(text)
    character(*), intent(in) :: kind
    character(:), allocatable :: text
    select case (kind)
    case ('NODE')
      text = 'node'
    case ('ELEMENT')
      text = 'el'
    case default
      text = 'joint'
    end select
  end function name_part

  !> The keyword that requests such a table.
  pure function keyword_of(kind) result(text)
    character(*), intent(in) :: kind
    character(:), allocatable :: text
    text = trim(kind)//' PRINT'
    if (kind == 'ELEMENT') text = 'EL PRINT'
  end function keyword_of

  !> The header line.
  function header_of(model, table, kind, fields) result(header)
    type(problem), intent(in) :: model
    type(result_field), intent(in) :: table(:) !< all fields
    character(*), intent(in) :: kind !< 'NODE', 'ELEMENT' or 'JOINT'
    integer, intent(in) :: fields(:) !< rows of the table, in the order of the request
    character(:), allocatable :: header
    integer :: i
    select case (kind)
    case ('NODE')
      header = 'step,increment,time,node'
    case ('ELEMENT')
      header = 'step,increment,time,element,point'
    case default
      header = 'step,increment,time,point,x,y,z'
      do i = 1, size(table)
        if (.not. table(i)%is_allowed_in('JOINT PRINT')) cycle
        header = header//','//lower(table(i)%columns(table(i)%width(model)))
      end do
      return
    end select
    do i = 1, size(fields)
      header = header//','//table(fields(i))%columns(table(fields(i))%width(model))
    end do
  end function header_of

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
    integer :: k, p, i
    do i = 1, size(record%fields)
      if (.not. record%fields(i)%is_allowed_in('JOINT PRINT')) cycle
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
