!> Nodes that follow others: u(node) = sum_k weight(k) u(master(k)), in all three directions.
module node_ties
  use kinds, only: rk
  implicit none
  private
  public :: node_tie

  !> One *TIE with an exact constraint, as links of single nodes of its slave face.
  type :: node_tie
    character(:), allocatable :: name !< upper case
    integer, allocatable :: node(:) !< (ties) the node that follows
    integer, allocatable :: first(:) !< (ties + 1)
    integer, allocatable :: master(:) !< nodes it follows, on either face
    real(rk), allocatable :: weight(:) !< they add up to 1
  end type node_tie
end module node_ties
