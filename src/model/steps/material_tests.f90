!> Tests of a material at one point, as *MATERIAL TEST asks for them: a path in legs, in each of
!> which every component follows a strain or a stress. Plain data.
!>
!> Order 11 22 33 12 13 23, shear strain as gamma, tension positive.
module material_tests
  use kinds, only: rk
  implicit none
  private
  public :: material_test, test_leg

  !> A part of the path. Each component goes straight from where it is to its target.
  type :: test_leg
    logical :: is_stress(6) = .false. !< the component follows a stress, else a strain
    logical :: is_held(6) = .false. !< it stays at the value it has at the start of the leg
    real(rk) :: target(6) = 0.0_rk !< at the end of the leg: strain, or stress [Pa]
    real(rk) :: share(6) = 0.0_rk !< of S11, which a stress follows besides its target
    integer :: num_increments = 100
    real(rk) :: duration = 1.0_rk !< [s]
  end type test_leg

  type :: material_test
    character(:), allocatable :: name !< upper case, part of the file's name
    character(:), allocatable :: kind !< TYPE: 'UNIAXIAL', 'GENERAL', ...
    integer :: material = 0 !< position in the problem's list
    integer :: driven = 0 !< component that the targets speak of, 0: no single one
    real(rk) :: length = 1.0_rk !< of the cube that the point stands for [m]
    real(rk) :: tolerance = 1.0e-9_rk !< of stresses that are held, over the largest so far
    type(test_leg), allocatable :: legs(:)
  end type material_test
end module material_tests
