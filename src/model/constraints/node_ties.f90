!> Nodes that follow others: u(node) = sum_k weight(k) u(master(k)), in the directions that are
!> tied.
module node_ties
  use kinds, only: rk
  implicit none
  private
  public :: node_tie

  !> One *TIE with an exact constraint, as links of single nodes of its slave face. A node may have
  !> several rows, in different directions: what follows there differs where supports do.
  type :: node_tie
    character(:), allocatable :: name !< upper case
    integer, allocatable :: node(:) !< (ties) the node that follows
    logical, allocatable :: is_tied(:, :) !< (3, ties) the directions in which it does
    integer, allocatable :: first(:) !< (ties + 1)
    integer, allocatable :: master(:) !< nodes it follows, on either face
    real(rk), allocatable :: weight(:) !< they add up to 1
  end type node_tie
end module node_ties
