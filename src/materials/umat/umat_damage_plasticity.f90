!> Plastic-damage concrete (paper, section 3) as a UMAT for other programs: the kernel of Keyway's
!> own material behind the interface of user subroutines.
!>
!> Needs, in this order, and nothing else of Keyway:
!>   base/kinds.f90 base/text/write_text.f90 base/math/small_matrix.f90 base/math/tensor6.f90
!>   materials/concrete/damage_constants.f90 materials/concrete/damage_curves.f90
!>   materials/concrete/damage_checks.f90 materials/concrete/damage_model.f90
!>   materials/concrete/damage_split.f90
!>   materials/concrete/damage_yield.f90 materials/law/crack_band.f90
!>   materials/concrete/damage_return.f90 materials/concrete/damage_increment.f90
!>   materials/concrete/damage_tangent.f90 materials/concrete/damage_energy.f90
!>   materials/concrete/damage_states.f90 materials/concrete/damage_work.f90
!>   materials/concrete/damage_point.f90 materials/concrete/damage_history.f90
!>   materials/umat/umat_concrete.f90
!> and this file. Free form, Fortran 2008; `tools/make_umat` writes all of it into one file.
!>
!> Constants, PROPS, in consistent units (docs/concrete_umat.md has an example):
!>    1 E_0            2 nu              3 dilation angle [deg]   4 offset (0.1)
!>    5 f_b0/f_c0      6 K_c             7 viscosity [s]
!>    8 recovery: 0 Lee-Fenves, 1 sign, 2 energy
!>    9 w_t           10 w_c
!>   11 tension against: 0 cracking strain, 1 opening, 2 one row f_t, G_f
!>   12 tension damage against: 0 cracking strain, 1 opening
!>   13 an element too long for its fracture energy: 0 is an error, 1 has a lower strength
!>   14 width of the crack band in place of CELENT, 0: CELENT
!>   15-18 rows of the tables: tension, tension damage, compression, compression damage
!>   19.. the tables one after the other, row by row: stress or damage, then its abscissa
!>
!> State, STATEV: 17 variables, zero at the start:
!>    1-6 plastic strain, engineering shear    7, 8 kappa_t, kappa_c    9, 10 d_t, d_c
!>   11 width of the crack band, 0 before the first crack
!>   12-17 plastic strain without viscosity
!>
!> For solids with six stress components and small strains. The tangent is unsymmetric. SSE is the
!> elastic energy, SPD the dissipated energy. Faults of constants are reported on the standard
!> output, and the stress is set to NaN so that the analysis stops. Tables are checked in the first
!> increment of the first step. A point that cannot be integrated requests a quarter of the
!> increment.
module umat_damage_plasticity
  use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
  use, intrinsic :: iso_c_binding, only: c_char, c_double, c_int
  use, intrinsic :: iso_fortran_env, only: output_unit
  use damage_history, only: last_backbone, pack_history, unpack_history
  use damage_model, only: concrete_model, placed_curves
  use damage_point, only: update_point
  use damage_states, only: point_answer, point_history, point_motion
  use kinds, only: rk
  use umat_concrete, only: make_model
  implicit none
  private
  public :: umat

  real(rk), parameter :: smaller = 0.25_rk !< of the increment

contains

  !> The interface of user subroutines. Not used: RPL, SCD and other arguments of temperature,
  !> PREDEF, COORDS, DROT, DFGRD0, DFGRD1, LAYER, KSPT. KSTEP and KINC identify the first increment,
  !> in which the tables are checked.
  subroutine umat(stress, statev, ddsdde, sse, spd, scd, rpl, ddsddt, drplde, drpldt, stran, &
                  dstran, time, dtime, temp, dtemp, predef, dpred, cmname, ndi, nshr, ntens, &
                  nstatv, props, nprops, coords, drot, pnewdt, celent, dfgrd0, dfgrd1, noel, &
                  npt, layer, kspt, kstep, kinc) bind(c, name='umat_')
    integer(c_int), intent(in) :: ndi, nshr, ntens, nstatv, nprops, noel, npt, layer, kspt
    integer(c_int), intent(in) :: kstep(4), kinc
    character(kind=c_char), intent(in) :: cmname(80)
    real(c_double), intent(inout) :: stress(ntens), statev(nstatv), ddsdde(ntens, ntens)
    real(c_double), intent(inout) :: sse, spd, scd, rpl, ddsddt(ntens), drplde(ntens), drpldt
    real(c_double), intent(inout) :: pnewdt
    real(c_double), intent(in) :: stran(ntens), dstran(ntens), time(2), dtime, temp, dtemp
    real(c_double), intent(in) :: predef(1), dpred(1), props(nprops), coords(3), drot(3, 3)
    real(c_double), intent(in) :: celent, dfgrd0(3, 3), dfgrd1(3, 3)
    type(concrete_model) :: model
    type(placed_curves) :: placed
    type(point_motion) :: motion
    type(point_history) :: old, new
    type(point_answer) :: answer
    character(:), allocatable :: fault
    real(rk) :: width
    integer :: i
    if (ntens /= 6 .or. ndi /= 3) then
      fault = 'elements without six stress components'
    else if (nstatv < last_backbone) then
      fault = 'fewer than 17 state variables'
    else
      call make_model(props, celent, kinc <= 1 .and. kstep(1) <= 1, model, width, fault)
    end if
    if (len(fault) > 0) then
      write (*, '(80a)') cmname
      write (*, '(2a,i0,a,i0)') fault, '; element ', noel, ', point ', npt
      flush (output_unit)
      stress = ieee_value(width, ieee_quiet_nan)
      return
    end if
    motion%before = stran
    motion%strain = stran + dstran
    motion%time = dtime
    motion%edges = reshape([width, (0.0_rk, 0.0_rk, 0.0_rk, width, i=1, 2)], [3, 3])
    call unpack_history(statev(:last_backbone), old)
    call update_point(model, motion, old, placed, new, answer)
    if (.not. answer%has_converged) pnewdt = smaller
    if (.not. answer%has_converged) return
    call pack_history(new, statev(:last_backbone))
    stress = answer%stress
    ddsdde = answer%tangent
    sse = answer%stored
    spd = spd + answer%fracture + answer%crushing
  end subroutine umat
end module umat_damage_plasticity
