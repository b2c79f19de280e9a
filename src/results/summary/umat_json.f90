!> The user's UMAT in job.json: its source, and the check of its tangents.
module umat_json
  use kinds, only: rk
  use json_writer, only: json_text
  use umat_findings, only: tangent_check
  use umat_loader, only: user_library
  implicit none
  private
  public :: put_umat

contains

  !> Writes the block of a run with a UMAT.
  subroutine put_umat(json, umat)
    type(json_text), intent(inout) :: json
    type(user_library), pointer, intent(in) :: umat
    integer :: i
    if (.not. associated(umat)) return
    call json%open_object('umat')
    call json%open_array('files')
    do i = 1, size(umat%files)
      call json%put_text(umat%files(i)%path)
    end do
    call json%close_array()
    if (umat%checks_tangent) call put_check(json, umat%found%check)
    call json%close_object()
  end subroutine put_umat

  !> DDSDDE compared with differences of STRESS, and the entry with the largest difference, if any.
  subroutine put_check(json, check)
    type(json_text), intent(inout) :: json
    type(tangent_check), intent(in) :: check
    call json%open_object('check')
    call json%put_integer(int(check%num_tangents), 'compared')
    if (check%error >= 0.0_rk) then
      call json%put_real(check%error, 'error')
      call json%put_integer(check%row, 'row')
      call json%put_integer(check%column, 'column')
      call json%put_real(check%given, 'given')
      call json%put_real(check%found, 'found')
      call json%put_text(check%place%material, 'material')
      call json%put_integer(check%place%element, 'element')
      call json%put_integer(check%place%point, 'point')
      call json%put_integer(check%place%step, 'step')
      call json%put_integer(check%place%increment, 'increment')
    end if
    call json%close_object()
  end subroutine put_check
end module umat_json
