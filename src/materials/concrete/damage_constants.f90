!> Constants of plastic-damage concrete, from a deck or from PROPS of a UMAT.
module damage_constants
  use kinds, only: rk
  implicit none
  private
  public :: concrete_constants

  !> Tables hold (2, rows): ordinate, abscissa.
  type :: concrete_constants
    real(rk) :: young = 0.0_rk !< E_0 [Pa]
    real(rk) :: poisson = 0.0_rk
    real(rk) :: dilation = 0.0_rk !< psi of Eq. 25 [deg]
    real(rk) :: offset = 0.1_rk !< xi of Eq. 25
    real(rk) :: biaxial_ratio = 1.16_rk !< f_b0/f_c0; alpha of Eq. 19 follows (paper_notes.md, 9)
    real(rk) :: meridian_ratio = 2.0_rk/3.0_rk !< K_c; gamma of Eq. 19 follows (paper_notes.md, 9)
    real(rk) :: viscosity = 0.0_rk !< of Duvaut and Lions [s]
    !> 'LEE-FENVES' (r of paper_notes.md, 8), 'SIGN' (r of Eq. 17) or 'ENERGY' (theory.md, (11.3a))
    character(10) :: recovery = 'LEE-FENVES'
    character(12) :: stiffening = 'STRAIN' !< 'STRAIN', 'DISPLACEMENT' or 'GFI'
    !> sigma_t [Pa] against cracking strain or opening [m]; GFI: one row, f_t [Pa] and G_f [N/m]
    real(rk), allocatable :: tension(:, :)
    character(12) :: tension_damage_type = 'STRAIN' !< 'STRAIN' or 'DISPLACEMENT'
    real(rk), allocatable :: tension_damage(:, :) !< d_t against cracking strain or opening [m]
    real(rk), allocatable :: compression(:, :) !< sigma_c [Pa] against inelastic strain
    real(rk), allocatable :: compression_damage(:, :) !< d_c against inelastic strain
    real(rk) :: tension_recovery = 0.0_rk !< w_t of Eq. 16
    real(rk) :: compression_recovery = 1.0_rk !< w_c of Eq. 16
    logical :: lowers_strength = .false. !< in elements too long for G_f; else an error
  end type concrete_constants
end module damage_constants
