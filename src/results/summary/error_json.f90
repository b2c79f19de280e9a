!> The errors that a run estimates, in job.json (theory.md, 14).
module error_json
  use kinds, only: rk
  use json_writer, only: json_text
  use run_records, only: run_record
  implicit none
  private
  public :: put_estimates

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
