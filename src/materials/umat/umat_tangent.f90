!> Comparison of DDSDDE with differences of STRESS: probes and result.
module umat_tangent
  use kinds, only: rk
  use umat_findings, only: call_place, tangent_check
  use umat_interface, only: umat_arguments
  implicit none
  private
  public :: strain_probes, compare_tangent, num_probes

  integer, parameter :: num_probes = 12 !< forward and backward for each strain component

  !> Step of the differences over the largest strain of the point: the cube root of round-off
  !> balances round-off and curvature in central differences.
  real(rk), parameter :: relative_step = 6.0e-6_rk
  real(rk), parameter :: smallest_strain = 1.0e-6_rk !< floor of the largest strain

contains

  pure real(rk) function step_of(answer) result(step)
    type(umat_arguments), intent(in) :: answer
    step = relative_step*max(smallest_strain, maxval(abs(answer%stran + answer%dstran)), &
                             maxval(abs(answer%dstran)))
  end function step_of

  !> Strain increments around that of a call: columns 2j-1 and 2j change component j up and down.
  pure function strain_probes(answer) result(dstran)
    type(umat_arguments), intent(in) :: answer !< of the UMAT
    real(rk) :: dstran(6, num_probes), step
    integer :: j
    step = step_of(answer)
    dstran = spread(answer%dstran, 2, num_probes)
    do j = 1, 6
      dstran(j, 2*j - 1) = dstran(j, 2*j - 1) + step
      dstran(j, 2*j) = dstran(j, 2*j) - step
    end do
  end function strain_probes

  !> Finds the entry with the largest error. The error is that to the nearest of forward, backward
  !> and central difference, because at a kink of the law (first yield) each side has its own
  !> tangent. Failed probes are skipped.
  pure subroutine compare_tangent(answer, place, stress, is_sound, check)
    type(umat_arguments), intent(in) :: answer !< of the UMAT, with its DDSDDE
    type(call_place), intent(in) :: place
    real(rk), intent(in) :: stress(6, num_probes) !< of the probes [Pa]
    logical, intent(in) :: is_sound(num_probes)
    type(tangent_check), intent(out) :: check
    real(rk) :: step, scale, quotients(6, 3)
    integer :: i, j, nearest
    step = step_of(answer)
    scale = max(maxval(abs(answer%ddsdde)), tiny(1.0_rk))
    check%place = place
    do j = 1, 6
      if (.not. all(is_sound(2*j - 1:2*j))) cycle
      associate (ahead => stress(:, 2*j - 1), behind => stress(:, 2*j))
        quotients(:, 1) = (ahead - behind)/(2.0_rk*step)
        quotients(:, 2) = (ahead - answer%stress)/step
        quotients(:, 3) = (answer%stress - behind)/step
      end associate
      do i = 1, 6
        nearest = minloc(abs(quotients(i, :) - answer%ddsdde(i, j)), 1)
        if (abs(quotients(i, nearest) - answer%ddsdde(i, j))/scale <= check%error) cycle
        check%error = abs(quotients(i, nearest) - answer%ddsdde(i, j))/scale
        check%row = i
        check%column = j
        check%given = answer%ddsdde(i, j)
        check%found = quotients(i, nearest)
      end do
    end do
  end subroutine compare_tangent
end module umat_tangent
