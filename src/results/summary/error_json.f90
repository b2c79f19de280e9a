!> The errors that a run estimates, in job.json (theory.md, 14).
module error_json
  use kinds, only: rk
  use json_writer, only: json_text
  use problem_definition, only: problem
  use run_records, only: run_record
  use run_summaries, only: follows_error, run_summary
  implicit none
  private
  public :: put_estimates, put_increments

contains

  !> The object `estimates` of `accuracy`: what is not estimated is left out.
  subroutine put_estimates(json, record)
    type(json_text), intent(inout) :: json
    type(run_record), intent(in) :: record
    call json%open_object('estimates')
    call put_stress(json, record)
    call put_displacement(json, record)
    call json%close_object()
  end subroutine put_estimates

  !> Steps whose increments follow the estimated error: the error over the largest displacement, and
  !> how many increments have which size.
  subroutine put_increments(json, model, summary)
    type(json_text), intent(inout) :: json
    type(problem), intent(in) :: model
    type(run_summary), intent(in) :: summary
    integer :: i, k
    call json%open_object('increments')
    do i = 1, size(summary%steps)
      associate (part => summary%steps(i))
        if (.not. follows_error(part)) cycle
        call json%open_object(model%steps(part%step)%name)
        call json%put_real(model%steps(part%step)%controls%accuracy, 'wanted')
        call json%put_real(part%accuracy%relative(), 'estimated_error')
        call json%open_array('sizes')
        do k = 1, size(part%sizes)
          call json%open_object()
          call json%put_real(part%sizes(k), 'size')
          call json%put_integer(part%of_size(k), 'increments')
          call json%close_object()
        end do
        call json%close_array()
        call json%close_object()
      end associate
    end do
    call json%close_object()
  end subroutine put_increments

  !> The largest displacement and the parts of its error; `history` is relative. With joints the
  !> error in time of the extreme is not known within a factor of 2 (theory.md, 14.3).
  subroutine put_displacement(json, record)
    type(json_text), intent(inout) :: json
    type(run_record), intent(in) :: record
    logical :: has_time, has_mesh
    associate (found => record%moved, largest => record%displacement%at(1))
      has_time = found%has_time(largest) .and. size(record%joints) == 0
      has_mesh = found%has_mesh(largest)
      if (.not. (has_time .or. has_mesh .or. found%history >= 0.0_rk)) return
      call json%open_object('displacement')
      call json%put_real(largest%value, 'value')
      if (has_time .or. has_mesh) then
        call json%put_real(merge(found%time, 0.0_rk, has_time) &
                           + merge(found%mesh, 0.0_rk, has_mesh), 'error')
      end if
      if (has_time) call json%put_real(found%time, 'time')
      if (has_mesh) call json%put_real(found%mesh, 'mesh')
      if (found%history >= 0.0_rk) call json%put_real(found%history, 'history')
      call json%close_object()
    end associate
  end subroutine put_displacement

  !> Energy norms of the stresses and of the error of the mesh.
  subroutine put_stress(json, record)
    type(json_text), intent(inout) :: json
    type(run_record), intent(in) :: record
    if (record%space%stress <= 0.0_rk) return
    call json%open_object('stress')
    call json%put_real(record%space%stress, 'value')
    call json%put_real(record%space%error, 'error')
    call json%put_real(record%space%error, 'mesh')
    call json%put_real(record%space%relative(), 'relative')
    call json%put_real(record%space%time, 'at')
    call json%close_object()
  end subroutine put_stress
end module error_json
