!> The table of fields: each row is whole, and each field has the values that its requests need.
program test_field_table
  use field_table, only: choices_of, columns_of_joints, fields_in_words, find_field, list_fields
  use field_type, only: at_elements, at_joints, at_nodes, at_points, on_faces, result_field
  use step_plan, only: field_name_length
  use testing, only: test_log, check, check_text
  implicit none
  character(11), parameter :: keywords(6) = ['NODE PRINT ', 'EL PRINT   ', 'JOINT PRINT', &
                                             'NODE FILE  ', 'EL FILE    ', 'ENVELOPE   ']
  type(test_log) :: log
  type(result_field), allocatable :: table(:)
  log%suite = 'field_table'
  call list_fields(table)
  call test_rows(log)
  call test_requests(log)
  call test_names(log)
  print '(i0,a,i0,a)', log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Every row has a name of its own and says what the field is.
  subroutine test_rows(log)
    type(test_log), intent(inout) :: log
    integer :: i
    do i = 1, size(table)
      associate (item => table(i))
        call check(log, find_field(table, item%name) == i, item%name//': the name is its own')
        call check(log, len(item%unit) > 0, item%name//' has a unit')
        call check(log, len(item%meaning) > 0, item%name//' has a meaning')
        call check(log, len(item%provider) > 0, item%name//' has a provider')
        call check(log, allocated(item%remark), item%name//' has a remark, or an empty one')
        call check(log, any(item%place == [at_nodes, at_elements, at_points, at_joints, &
                                           on_faces]), &
                   item%name//' has a place')
        call check(log, item%requests == '' .or. len(item%name) <= field_name_length, &
                   item%name//' can be stored in a request')
      end associate
    end do
    call check(log, find_field(table, 'HUMIDITY') == 0, 'an unknown field')
  end subroutine test_rows

  !> Every writer can write each field that a deck may ask of it.
  subroutine test_requests(log)
    type(test_log), intent(inout) :: log
    logical :: is_right
    integer :: i, k
    do i = 1, size(table)
      do k = 1, size(keywords)
        if (.not. table(i)%is_allowed_in(trim(keywords(k)))) cycle
        call check(log, can_be_written(table(i), trim(keywords(k))), &
                   table(i)%name//' of *'//trim(keywords(k))//' has values')
      end do
      is_right = .true.
      if (any(table(i)%place == [at_joints, on_faces])) is_right = associated(table(i)%of_joint)
      call check(log, is_right, table(i)%name//' can be drawn on the faces of joints')
    end do
    do k = 1, size(keywords)
      call check(log, len(choices_of(trim(keywords(k)))) > 0, '*'//trim(keywords(k))//' has fields')
    end do
  end subroutine test_requests

  !> Does the row have the values that a keyword's writers use?
  logical function can_be_written(item, keyword)
    type(result_field), intent(in) :: item
    character(*), intent(in) :: keyword
    select case (keyword)
    case ('EL PRINT')
      can_be_written = associated(item%of_solids)
    case ('JOINT PRINT')
      can_be_written = associated(item%of_joint)
    case ('ENVELOPE')
      can_be_written = associated(item%on_nodes)
      if (item%place == at_points) can_be_written = associated(item%of_block)
      if (item%place == at_joints) can_be_written = associated(item%of_joint)
    case default
      can_be_written = associated(item%on_nodes)
    end select
  end function can_be_written

  !> Names of components, columns, choices.
  subroutine test_names(log)
    type(test_log), intent(inout) :: log
    associate (stress => table(find_field(table, 'S')), &
               variables => table(find_field(table, 'SDV')), &
               traction => table(find_field(table, 'TRACTION')), &
               damage => table(find_field(table, 'DAMAGET')))
      call check_text(log, stress%components(6), 'S11,S22,S33,S12,S13,S23', 'a tensor')
      call check(log, stress%is_tensor() .and. .not. traction%is_tensor(), 'what is a tensor')
      call check_text(log, traction%columns(3), 'TN,T1,T2', 'a stem of its own')
      call check_text(log, variables%columns(1), 'SDV1', 'one state variable')
      call check_text(log, variables%components(12), &
                      'SDV1,SDV2,SDV3,SDV4,SDV5,SDV6,SDV7,SDV8,SDV9,SDV10,SDV11,SDV12', 'twelve')
      call check_text(log, damage%columns(1), 'DAMAGET', 'the column of a scalar')
      call check_text(log, damage%components(1), '', 'a scalar has no components')
      call check_text(log, damage%columns(0), '', 'no column where the model has no damage')
    end associate
    call check_text(log, choices_of('JOINT PRINT'), &
                    'OPENING | SLIP | TRACTION | STATE | SLIP1 | SLIP2 | TN | T1 | T2', 'choices')
    call check_text(log, fields_in_words('NODE PRINT'), &
                    'U displacement, V velocity, A acceleration, RF reaction, TEMP temperature', &
                    'in words')
    call check_text(log, columns_of_joints(), &
                    'opening [m], slip1, slip2 [m], tn, t1, t2 [Pa], state', 'columns of joints')
  end subroutine test_names
end program test_field_table
