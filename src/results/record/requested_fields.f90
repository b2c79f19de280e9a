!> Fields that an increment writes.
module requested_fields
  use problem_definition, only: problem
  use analysis_state, only: state
  use field_table, only: find_field
  use field_type, only: at_joints, by_guest, by_law
  use run_records, only: run_record
  use print_kinds, only: prints_of_joints
  use reduced_nodes, only: is_followed
  use result_writer, only: is_due, meets
  use step_plan, only: step
  implicit none
  private
  public :: list_due_fields, asks_for_joints, is_of_law, needs_nodes

contains

  !> Fields of all requests with output now, each once, as rows of the record's table; fields of
  !> guests accompany them. A field that
  !> the analysis does not have now is left out, with one warning. For fields of laws the reader of
  !> the deck has warned.
  subroutine list_due_fields(model, now, record, fields)
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(run_record), intent(inout) :: record
    integer, allocatable, intent(out) :: fields(:)
    integer :: r, i, f
    allocate (fields(0))
    if (.not. allocated(model%steps(now%step)%outputs)) return
    if (now%is_stop .and. any(meets(now, max(1, model%steps(now%step)%outputs%frequency)))) return
    do r = 1, size(model%steps(now%step)%outputs)
      associate (request => model%steps(now%step)%outputs(r))
        if (.not. is_due(now, request%frequency)) cycle
        do i = 1, size(request%fields)
          f = find_field(record%fields, trim(request%fields(i)))
          if (any(fields == f)) cycle
          if (is_written(model, now, record, f)) then
            fields = [fields, f]
          else if (.not. is_of_law(record, f)) then
            call warn_of_missing(model%steps(now%step), trim(request%fields(i)), record)
          end if
        end do
      end associate
    end do
    if (size(fields) == 0) return
    fields = [fields, pack([(f, f=1, size(record%fields))], &
                           [(record%fields(f)%provider == by_guest, f=1, size(record%fields))])]
  end subroutine list_due_fields

  !> Warns once of a field that steps do not have.
  subroutine warn_of_missing(plan, name, record)
    type(step), intent(in) :: plan
    character(*), intent(in) :: name !< of the field
    type(run_record), intent(inout) :: record
    if (plan%procedure%is_static() .and. (name == 'V' .or. name == 'A')) then
      call record%warn_once('static steps have no field '//name//': job.h5 and the VTK series '// &
                            'are without it there')
    else
      call record%warn_once('step '//plan%name//' has no field '//name//'; it is not written')
    end if
  end subroutine warn_of_missing

  !> Whether a checkpoint, an envelope or a request of nodes, elements or fields needs the motion of
  !> the nodes now.
  pure logical function needs_nodes(model, now, record)
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(run_record), intent(in) :: record
    needs_nodes = now%is_last_of_step .or. record%has_envelope_of_nodes() &
                  .or. is_due(now, model%steps(now%step)%checkpoint_frequency) &
                  .or. writes_nodes(model, now)
  end function needs_nodes

  !> Whether a request of nodes, elements or fields is due; a reduced model follows some nodes.
  pure logical function writes_nodes(model, now)
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    integer :: r
    writes_nodes = .false.
    associate (plan => model%steps(now%step))
      if (allocated(plan%outputs)) then
        do r = 1, size(plan%outputs)
          writes_nodes = writes_nodes .or. is_due(now, plan%outputs(r)%frequency)
        end do
      end if
      if (.not. allocated(plan%prints)) return
      do r = 1, size(plan%prints)
        if (plan%prints(r)%kind == prints_of_joints .or. is_followed(plan%prints(r))) cycle
        writes_nodes = writes_nodes .or. is_due(now, plan%prints(r)%frequency)
      end do
    end associate
  end function writes_nodes

  !> Can this field be written on nodes now?
  logical function is_written(model, now, record, f)
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(run_record), intent(in) :: record
    integer, intent(in) :: f !< row of the record's table, 0: an unknown field
    is_written = .false.
    if (f == 0) return
    associate (item => record%fields(f))
      if (associated(item%on_nodes)) is_written = item%is_available(model, now)
    end associate
  end function is_written

  !> Do material laws compute this field?
  logical function is_of_law(record, f)
    type(run_record), intent(in) :: record
    integer, intent(in) :: f !< row of the record's table, 0: an unknown field
    is_of_law = .false.
    if (f > 0) is_of_law = record%fields(f)%provider == by_law
  end function is_of_law

  !> Is one of the fields defined at points of joints?
  pure logical function asks_for_joints(record, fields)
    type(run_record), intent(in) :: record
    integer, intent(in) :: fields(:) !< rows of the record's table
    asks_for_joints = any(record%fields(fields)%place == at_joints)
  end function asks_for_joints
end module requested_fields
