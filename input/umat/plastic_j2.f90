! Metal plasticity of von Mises with a table of isotropic hardening.
!
! Shows: free form, state variables, radial return with its consistent tangent, energies, a message
! that gives up the increment.
! Constants (*USER MATERIAL, CONSTANTS=2 + 2 n):
!   props(1)  E, Young's modulus [Pa]
!   props(2)  nu, Poisson's ratio
!   props(3), props(4), ..  n rows: yield stress [Pa], equivalent plastic strain; the first at 0,
!             strains growing. Straight between the rows, constant beyond the last.
! State variables (*DEPVAR 7):
!   statev(1)    equivalent plastic strain p
!   statev(2:7)  plastic strain 11 22 33 12 13 23, engineering shear
!
! With q the equivalent stress of the elastic trial and n its deviatoric direction (n:n = 1), the
! plastic strain grows by sqrt(3/2) dp n, and dp solves q - 3 G dp = yield(p + dp). The table being
! straight between its rows, that is one division in the right segment. Differentiating it gives the
! tangent; H is the slope of the segment, 1 - 3 G dp/q the share of the trial that stays:
!   D = K 1 1 + 2 G (1 - 3 G dp/q) I_dev - 6 G^2 (1/(3 G + H) - dp/q) n n
! allow(C092) other programs look for this very symbol
subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, &
                dstran, time, dtime, temp, dtemp, predef, dpred, cmname, ndi, nshr, ntens, &
                nstatv, props, nprops, coords, drot, pnewdt, celent, dfgrd0, dfgrd1, noel, npt, &
                layer, kspt, kstep, kinc)
  implicit none
  integer, parameter :: rk = kind(1.0d0)
  integer, intent(in) :: ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt, kstep(4), kinc
  character(80), intent(in) :: cmname
  real(rk), intent(inout) :: stress(ntens), statev(nstatv), ddsdde(ntens, ntens)
  real(rk), intent(inout) :: sse, spd, scd, rpl, ddsddt(ntens), drplde(ntens), drpldt, pnewdt
  real(rk), intent(in) :: stran(ntens), dstran(ntens), time(2), dtime, temp, dtemp
  real(rk), intent(in) :: predef(1), dpred(1), props(nprops), coords(3), drot(3, 3), celent
  real(rk), intent(in) :: dfgrd0(3, 3), dfgrd1(3, 3)
  real(rk), parameter :: small = 1.0e-12_rk ! of the yield stress: round-off of the trial
  real(rk) :: shear, bulk, lambda, before(ntens), deviator(ntens), direction(ntens)
  real(rk) :: share, mean, length, trial, dp, old_yield, new_yield, slope, slope_end
  integer :: i

  if (nstatv < 7 .or. nprops < 4 .or. mod(nprops, 2) /= 0 .or. ndi /= 3) then
    call stdb_abqerr(-3, 'plastic_j2 wants 7 state variables (%I given) and 2 + 2 n constants '// &
                     '(%I given)', [nstatv, nprops], [0.0_rk], ['        '])
  end if
  shear = props(1)/(2.0_rk*(1.0_rk + props(2)))
  bulk = props(1)/(3.0_rk*(1.0_rk - 2.0_rk*props(2)))
  lambda = bulk - 2.0_rk*shear/3.0_rk

  ! Elastic trial
  ddsdde = 0.0_rk
  ddsdde(:ndi, :ndi) = lambda
  do i = 1, ndi
    ddsdde(i, i) = lambda + 2.0_rk*shear
  end do
  do i = ndi + 1, ntens
    ddsdde(i, i) = shear
  end do
  before = stress
  stress = stress + matmul(ddsdde, dstran)
  mean = sum(stress(:ndi))/3.0_rk
  deviator = stress
  deviator(:ndi) = stress(:ndi) - mean
  length = sqrt(sum(deviator(:ndi)**2) + 2.0_rk*sum(deviator(ndi + 1:)**2))
  trial = sqrt(1.5_rk)*length

  call read_table(statev(1), old_yield, slope, slope_end)
  if (trial > old_yield*(1.0_rk + small)) then
    call find_plastic_strain(trial, dp, new_yield, slope)
    direction = deviator/length
    stress = deviator*(new_yield/trial)
    stress(:ndi) = stress(:ndi) + mean
    share = new_yield/trial
    ddsdde = -6.0_rk*shear**2*(1.0_rk/(3.0_rk*shear + slope) - dp/trial) &
             *spread(direction, 2, ntens)*spread(direction, 1, ntens)
    ddsdde(:ndi, :ndi) = ddsdde(:ndi, :ndi) + bulk - 2.0_rk*shear*share/3.0_rk
    do i = 1, ndi
      ddsdde(i, i) = ddsdde(i, i) + 2.0_rk*shear*share
    end do
    do i = ndi + 1, ntens
      ddsdde(i, i) = ddsdde(i, i) + shear*share
    end do
    statev(1) = statev(1) + dp
    statev(2:1 + ndi) = statev(2:1 + ndi) + sqrt(1.5_rk)*dp*direction(:ndi)
    statev(2 + ndi:1 + ntens) = statev(2 + ndi:1 + ntens) &
                                + 2.0_rk*sqrt(1.5_rk)*dp*direction(ndi + 1:)
    ! Work of the mean stress on the plastic strain
    spd = spd + sqrt(1.5_rk)*dp*0.5_rk*(dot_product(before(:ndi) + stress(:ndi), direction(:ndi)) &
                                        + 2.0_rk*dot_product(before(ndi + 1:) + stress(ndi + 1:), &
                                                             direction(ndi + 1:)))
  end if
  sse = 0.5_rk*(dot_product(stress, stran + dstran) - dot_product(stress, statev(2:1 + ntens)))

contains

  ! Yield stress at a plastic strain, the slope beyond it and the strain where that slope ends.
  subroutine read_table(p, yield, h, last)
    real(rk), intent(in) :: p
    real(rk), intent(out) :: yield, h, last
    integer :: row
    row = 3
    do while (row + 3 <= nprops)
      if (p < props(row + 3)) exit
      row = row + 2
    end do
    h = 0.0_rk
    last = huge(last)
    if (row + 3 <= nprops) then
      last = props(row + 3)
      h = (props(row + 2) - props(row))/(last - props(row + 1))
    end if
    yield = props(row) + h*(p - props(row + 1))
  end subroutine read_table

  ! Growth of the plastic strain for a trial stress, from segment to segment of the table.
  subroutine find_plastic_strain(q, growth, yield, h)
    real(rk), intent(in) :: q
    real(rk), intent(out) :: growth, yield, h
    real(rk) :: last
    growth = 0.0_rk
    do
      call read_table(statev(1) + growth, yield, h, last)
      growth = growth + (q - 3.0_rk*shear*growth - yield)/(3.0_rk*shear + h)
      if (statev(1) + growth <= last) exit
      growth = last - statev(1)
    end do
    yield = q - 3.0_rk*shear*growth
  end subroutine find_plastic_strain
end subroutine umat
