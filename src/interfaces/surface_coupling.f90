!> Springs between two faces of different meshes: Eqs 1-8 at the points of their segments.
!>
!> At point p the faces differ by delta u = sum_k weight(k) u(node(k)), k = first(p) .. first(p+1)-1
!> (Eqs 1-5: N_m u_m). Springs of `stiffness` per area resist it in x, y and z alike (Eq 6):
!>   K = sum_p area(p) N_m^T k N_m   (Eq 8).
module surface_coupling
  use kinds, only: rk
  implicit none
  private
  public :: coupling

  type :: coupling
    character(:), allocatable :: name !< upper case
    character(:), allocatable :: kind !< its keyword: 'INTERFACE' or 'TIE'
    real(rk) :: stiffness = 0.0_rk !< k_x = k_y = k_z [Pa/m]
    integer, allocatable :: first(:) !< (points + 1)
    integer, allocatable :: node(:) !< positions in the mesh
    real(rk), allocatable :: weight(:) !< slave positive, master negative
    real(rk), allocatable :: area(:) !< (points) [m2]
  end type coupling
end module surface_coupling
