!> The data of the *CONCRETE keywords of a material.
module concrete_request
  use damage_constants, only: concrete_constants
  use model_draft, only: origin
  implicit none
  private
  public :: concrete_cards

  !> An origin with card 0: the keyword is not given.
  type :: concrete_cards
    integer :: material = 0 !< position
    type(concrete_constants) :: constants
    type(origin) :: plasticity, hardening, stiffening, compression_damage, tension_damage
    logical :: is_right = .true. !< its cards agree with their specifications
  end type concrete_cards
end module concrete_request
