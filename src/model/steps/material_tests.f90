!> Tests of a material at one point, as *MATERIAL TEST defines them: a path in legs; in each leg
!> every component follows a strain or a stress. Plain data.
!>
!> Order 11 22 33 12 13 23, shear strain as gamma, tension positive.
module material_tests
  use kinds, only: rk
  implicit none
  private
  public :: material_test, test_leg

  !> A part of the path. Each component changes linearly from its current value to its target.
  type :: test_leg
    logical :: is_stress(6) = .false. !< the component follows a stress, else a strain
    logical :: is_held(6) = .false. !< constant at its value at the start of the leg
    real(rk) :: target(6) = 0.0_rk !< at the end of the leg: strain, or stress [Pa]
    real(rk) :: share(6) = 0.0_rk !< multiple of S11 that is added to a target stress
    integer :: num_increments = 100
    real(rk) :: duration = 1.0_rk !< [s]
  end type test_leg

  type :: material_test
    character(:), allocatable :: name !< upper case, part of the file's name
    character(:), allocatable :: kind !< TYPE: 'UNIAXIAL', 'GENERAL', ...
    integer :: material = 0 !< position in the problem's list
    integer :: driven = 0 !< component of the targets, 0: several
    real(rk) :: length = 1.0_rk !< edge of the cube that the point represents [m]
    real(rk) :: tolerance = 1.0e-9_rk !< of prescribed stresses, over the largest so far
    type(test_leg), allocatable :: legs(:)
  end type material_test
end module material_tests
