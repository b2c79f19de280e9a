!> Columns and rows of the CSV histories.
module history_rows
  use kinds, only: rk
  use problem_definition, only: problem
  use analysis_state, only: state
  use tensor6, only: principal_values
  use joint_readings, only: opening_at_points
  use law_fields, only: width_of_field, field_at_points
  use requested_fields, only: components_of
  use stress_fields, only: recovered_fields
  use text_buffers, only: text_buffer
  use write_text, only: as_text
  implicit none
  private
  public :: name_part, header_of, columns_of
  public :: add_node_rows, add_element_rows, add_joint_rows

  !> A field at the points of all solids.
  type :: point_values
    real(rk), allocatable :: at(:, :, :) !< (components, max_points, solids)
  end type point_values

contains

  !> Part of the file's name.
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

  !> The header line.
  function header_of(scene, kind, fields) result(header)
    type(problem), intent(in) :: scene
    character(*), intent(in) :: kind !< 'NODE', 'ELEMENT' or 'JOINT'
    character(*), intent(in) :: fields(:) !< in the order in which they were asked for
    character(:), allocatable :: header
    integer :: i
    select case (kind)
    case ('NODE')
      header = 'step,increment,time,node'
    case ('ELEMENT')
      header = 'step,increment,time,element,point'
    case default
      header = 'step,increment,time,point,x,y,z,opening,slip1,slip2,tn,t1,t2,state'
      return
    end select
    do i = 1, size(fields)
      header = header//columns_of(scene, kind, fields(i))
    end do
  end function header_of

  !> The columns of a field, each with its comma in front; empty when there is no such field.
  function columns_of(scene, kind, name) result(columns)
    type(problem), intent(in) :: scene
    character(*), intent(in) :: kind, name
    character(:), allocatable :: columns
    integer :: width, i
    columns = ''
    select case (kind//' '//name)
    case ('NODE U', 'NODE V', 'NODE A', 'NODE RF', 'ELEMENT SP')
      columns = ','//components_of(name, 3)
    case ('ELEMENT S', 'ELEMENT E')
      columns = ','//components_of(name, 6)
    case ('ELEMENT PE', 'ELEMENT DAMAGET', 'ELEMENT DAMAGEC')
      width = width_of_field(scene, name)
      if (width == 1) columns = ','//trim(name)
      if (width > 1) columns = ','//components_of(name, width)
    case ('ELEMENT SDV')
      do i = 1, width_of_field(scene, name)
        columns = columns//',SDV'//as_text(i)
      end do
    case default
      columns = ''
    end select
  end function columns_of

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

  !> Reals, each with its comma in front.
  subroutine add_reals(lines, numbers)
    type(text_buffer), intent(inout) :: lines
    real(rk), intent(in) :: numbers(:)
    integer :: i
    do i = 1, size(numbers)
      call lines%add(',')
      call lines%add_real(numbers(i))
    end do
  end subroutine add_reals

  !> One row for each node.
  subroutine add_node_rows(lines, scene, now, fields, nodes)
    type(text_buffer), intent(inout) :: lines
    type(problem), intent(in) :: scene
    type(state), intent(in) :: now
    character(*), intent(in) :: fields(:)
    integer, intent(in) :: nodes(:) !< positions
    integer :: k, i
    do k = 1, size(nodes)
      call add_time(lines, now)
      call lines%add(',')
      call lines%add_integer(scene%mesh%node_id(nodes(k)))
      do i = 1, size(fields)
        call add_reals(lines, node_value(now, fields(i), nodes(k)))
      end do
      call lines%add(new_line('a'))
    end do
  end subroutine add_node_rows

  !> A vector of a node; velocities and accelerations are zero in a static step.
  pure function node_value(now, name, node) result(value)
    type(state), intent(in) :: now
    character(*), intent(in) :: name
    integer, intent(in) :: node
    real(rk) :: value(3)
    value = 0.0_rk
    select case (name)
    case ('U')
      value = now%u(:, node)
    case ('V')
      if (allocated(now%v)) value = now%v(:, node)
    case ('A')
      if (allocated(now%a)) value = now%a(:, node)
    case ('RF')
      if (allocated(now%reaction)) value = now%reaction(:, node)
    case default
      value = 0.0_rk
    end select
  end function node_value

  !> One row for each integration point of each solid; other elements have none.
  subroutine add_element_rows(lines, scene, now, stresses, fields, elements)
    type(text_buffer), intent(inout) :: lines
    type(problem), intent(in) :: scene
    type(state), intent(in) :: now
    type(recovered_fields), intent(in) :: stresses !< with points
    character(*), intent(in) :: fields(:)
    integer, intent(in) :: elements(:) !< positions
    type(point_values) :: of_laws(size(fields))
    integer :: k, s, q, i
    do i = 1, size(fields)
      if (any(fields(i) == ['S ', 'E ', 'SP'])) cycle
      call field_at_points(scene, stresses%plan, now, fields(i), of_laws(i)%at)
    end do
    do k = 1, size(elements)
      s = stresses%plan%solid_of_element(elements(k))
      if (s == 0) cycle
      do q = 1, stresses%plan%num_points(s)
        call add_time(lines, now)
        call lines%add(',')
        call lines%add_integer(scene%mesh%element_id(elements(k)))
        call lines%add(',')
        call lines%add_integer(q)
        do i = 1, size(fields)
          select case (fields(i))
          case ('S')
            call add_reals(lines, stresses%point_stress(:, q, s))
          case ('E')
            call add_reals(lines, stresses%point_strain(:, q, s))
          case ('SP')
            call add_reals(lines, principal_values(stresses%point_stress(:, q, s)))
          case default
            call add_reals(lines, of_laws(i)%at(:, q, s))
          end select
        end do
        call lines%add(new_line('a'))
      end do
    end do
  end subroutine add_element_rows

  !> One row for each chosen point of a joint.
  subroutine add_joint_rows(lines, scene, now, joint, points)
    type(text_buffer), intent(inout) :: lines
    type(problem), intent(in) :: scene
    type(state), intent(in) :: now
    integer, intent(in) :: joint !< position in the problem
    integer, intent(in) :: points(:)
    real(rk) :: opening(scene%joints(joint)%num_points)
    integer :: k, p
    opening = opening_at_points(now%joints(joint))
    do k = 1, size(points)
      p = points(k)
      call add_time(lines, now)
      call lines%add(',')
      call lines%add_integer(p)
      call add_reals(lines, scene%joints(joint)%x(:, p))
      call add_reals(lines, [opening(p), now%joints(joint)%slip(:, p)])
      call add_reals(lines, now%joints(joint)%traction(:, p))
      call lines%add(',')
      call lines%add_integer(now%joints(joint)%status(p))
      call lines%add(new_line('a'))
    end do
  end subroutine add_joint_rows
end module history_rows
