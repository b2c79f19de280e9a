!> DDSDDE against differences of STRESS.
module umat_tangent
  use kinds, only: rk
  use umat_findings, only: call_place, findings, tangent_check
  use umat_interface, only: umat_arguments
  implicit none
  private
  public :: compare_tangent

  !> Step of the differences over the largest strain of the point: the cube root of the round-off
  !> of a double balances it against the curvature in central differences.
  real(rk), parameter :: relative_step = 6.0e-6_rk
  real(rk), parameter :: smallest_strain = 1.0e-6_rk !< that the step is measured by

  abstract interface
    !> The stress after a strain increment, from the history of the call that is checked.
    subroutine stress_of_increment(dstran, stress, is_sound)
      import :: rk
      implicit none
      real(rk), intent(in) :: dstran(6)
      real(rk), intent(out) :: stress(6)
      logical, intent(out) :: is_sound
    end subroutine stress_of_increment
  end interface

contains

  !> Compares all entries, and adds the worst to what is found. Each is compared with the forward,
  !> the backward and the central difference, and the nearest counts: at a corner of the law (first
  !> yield) each side has its own tangent.
  subroutine compare_tangent(answer, place, stress_after, found)
    type(umat_arguments), intent(in) :: answer !< of the UMAT, with its DDSDDE
    type(call_place), intent(in) :: place
    procedure(stress_of_increment) :: stress_after
    type(findings), intent(inout) :: found
    type(tangent_check) :: new
    real(rk) :: dstran(6), ahead(6), behind(6), step, scale, quotients(6, 3)
    integer :: i, j, nearest
    logical :: is_sound, is_sound_behind
    step = relative_step*max(smallest_strain, maxval(abs(answer%stran + answer%dstran)), &
                             maxval(abs(answer%dstran)))
    scale = max(maxval(abs(answer%ddsdde)), tiny(1.0_rk))
    new%place = place
    do j = 1, 6
      dstran = answer%dstran
      dstran(j) = dstran(j) + step
      call stress_after(dstran, ahead, is_sound)
      dstran(j) = answer%dstran(j) - step
      call stress_after(dstran, behind, is_sound_behind)
      if (.not. is_sound .or. .not. is_sound_behind) cycle
      quotients(:, 1) = (ahead - behind)/(2.0_rk*step)
      quotients(:, 2) = (ahead - answer%stress)/step
      quotients(:, 3) = (answer%stress - behind)/step
      do i = 1, 6
        nearest = minloc(abs(quotients(i, :) - answer%ddsdde(i, j)), 1)
        if (abs(quotients(i, nearest) - answer%ddsdde(i, j))/scale <= new%error) cycle
        new%error = abs(quotients(i, nearest) - answer%ddsdde(i, j))/scale
        new%row = i
        new%column = j
        new%given = answer%ddsdde(i, j)
        new%found = quotients(i, nearest)
      end do
    end do
    call found%add_check(new)
  end subroutine compare_tangent
end module umat_tangent
