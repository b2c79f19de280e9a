!> The estimate of errors in the lowest modes, in a step that goes on from a checkpoint.
!>
!> The modes are found anew. With other threads or ranks round-off may turn a mode around, or mix
!> modes of one frequency. The motion of the checkpoint shows which: the run's own displacements and
!> forces in the modes, q = exact + error and drive, are those of the modes of the checkpoint.
module resumed_modes
  use analysis_state, only: motion
  use kinds, only: rk
  use modal_errors, only: modal_error
  use time_error, only: displacement_of, drive_modes, error_modes
  implicit none
  private
  public :: resume_modal_error

  !> A difference, over the largest value of a mode, that is round-off. Modes come from an
  !> eigenvalue solver that ends at 1e-8 or less.
  real(rk), parameter :: round_off = 1.0e-5_rk

contains

  !> Turns the modal motion of the checkpoint where the modes are turned. Where they are others,
  !> there is no estimate any more: the modes are taken away.
  subroutine resume_modal_error(modes, moving, own)
    type(error_modes), intent(inout) :: modes
    type(motion), intent(in) :: moving !< of the checkpoint
    type(modal_error), intent(inout) :: own !< of the checkpoint
    real(rk), dimension(size(modes%square)) :: q, rate, drive, old, turn
    logical :: fits
    fits = allocated(own%exact)
    if (fits) fits = size(own%exact) == size(modes%square)
    if (.not. fits) then
      deallocate (modes%square)
      return
    end if
    q = displacement_of(modes, moving%q)
    call drive_modes(modes, moving, q, rate, drive)
    old = own%exact + own%error
    turn = sign(1.0_rk, share(q)*share(old) + share(drive)*share(own%drive))
    if (differ(turn*old, q) .or. differ(turn*own%drive, drive)) then
      deallocate (modes%square)
    else if (any(turn < 0.0_rk)) then
      call turn_modes(turn, own)
    end if
  end subroutine resume_modal_error

  !> Values over the largest of them.
  pure function share(values) result(shares)
    real(rk), intent(in) :: values(:)
    real(rk) :: shares(size(values))
    shares = values/max(tiny(1.0_rk), maxval(abs(values)))
  end function share

  !> Whether values differ by more than round-off.
  pure logical function differ(one, other)
    real(rk), intent(in) :: one(:), other(:)
    differ = maxval(abs(one - other)) > round_off*max(maxval(abs(one)), maxval(abs(other)))
  end function differ

  !> Turns what belongs to a mode.
  pure subroutine turn_modes(turn, own)
    real(rk), intent(in) :: turn(:) !< (modes) 1 or -1
    type(modal_error), intent(inout) :: own
    integer :: k
    own%exact = turn*own%exact
    own%rate = turn*own%rate
    own%drive = turn*own%drive
    own%carried = turn*own%carried
    own%carried_rate = turn*own%carried_rate
    own%error = turn*own%error
    if (allocated(own%softer)) then
      own%softer = turn*own%softer
      own%softer_rate = turn*own%softer_rate
    end if
    if (allocated(own%mesh_at_most)) own%mesh_at_most = turn*own%mesh_at_most
    if (.not. allocated(own%square)) return
    do k = 1, size(turn)
      own%square(:, k) = turn(k)*turn*own%square(:, k)
    end do
    own%product = turn*own%product
    own%at_most = turn*own%at_most
  end subroutine turn_modes
end module resumed_modes
