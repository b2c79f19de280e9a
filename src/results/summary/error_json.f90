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
    call json%close_object()
  end subroutine put_estimates

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
