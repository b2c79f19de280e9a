!> What the catalogue holds of a keyword: its specification and the procedure that understands it.
module keyword_handler
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use keyword_spec, only: keyword
  use model_draft, only: draft
  implicit none
  private
  public :: entry_of_catalogue, card_handler
  public :: pass_nodes, pass_elements, pass_definitions, pass_rest

  !> The deck is gone through in passes, so that nodes, elements and definitions (materials,
  !> amplitudes, joint laws) may stand anywhere. Sets must stand above their use.
  integer, parameter :: pass_nodes = 1, pass_elements = 2, pass_definitions = 3, pass_rest = 4

  type :: entry_of_catalogue
    type(keyword) :: spec
    integer :: pass = pass_rest
    procedure(card_handler), pointer, nopass :: handle => null() !< null: not available
  end type entry_of_catalogue

  abstract interface
    !> Understands a card that agrees with its specification.
    subroutine card_handler(this, model, faults)
      import :: card, draft, diagnostic_list
      type(card), intent(in) :: this
      type(draft), intent(inout) :: model
      type(diagnostic_list), intent(inout) :: faults
    end subroutine card_handler
  end interface
end module keyword_handler
