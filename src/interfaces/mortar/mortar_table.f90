!> The rows of a mortar projection (different_meshes.md, 13.2).
module mortar_table
  use kinds, only: rk
  implicit none
  private
  public :: mortar_rows

  !> Row a gives the displacement of the master face opposite a node of the slave face:
  !> sum_k weight(k) u(master(k)), k = first(a) .. first(a + 1) - 1.
  type :: mortar_rows
    integer :: num_rows = 0
    integer, allocatable :: node(:) !< (rows) node of the slave face
    integer, allocatable :: first(:) !< (rows + 1)
    integer, allocatable :: master(:) !< nodes of the master face, and bound ones of the slave face
    real(rk), allocatable :: weight(:) !< they add up to 1
    real(rk), allocatable :: area(:) !< (rows) A_a = int N_a dA [m2]
    real(rk), allocatable :: pressed(:, :) !< (3, rows) int N_a n dA: force of a unit pressure [m2]
    real(rk), allocatable :: normal(:, :) !< (3, rows) unit, out of the slave's solid
    real(rk), allocatable :: gap(:) !< (rows) (1/A_a) int phi_a gap dA, from slave to master [m]
    real(rk), allocatable :: facet_size(:) !< (rows) shortest side of the facets that meet there [m]
    logical, allocatable :: is_bare(:) !< (slave facets) too little covered to be used
  end type mortar_rows
end module mortar_table
