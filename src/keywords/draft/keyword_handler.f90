!> The handler of a card, and the list of keywords.
module keyword_handler
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use keyword_spec, only: keyword
  use model_draft, only: draft
  implicit none
  private
  public :: keyword_list, keyword_entry, card_handler, spec_maker
  public :: pass_nodes, pass_elements, pass_definitions, pass_rest

  !> The cards are handled in passes, so that nodes, elements and definitions (materials,
  !> amplitudes, joint laws) may be anywhere in the deck. Sets must be defined above their use.
  integer, parameter :: pass_nodes = 1, pass_elements = 2, pass_definitions = 3, pass_rest = 4

  !> How a keyword is handled.
  type :: keyword_entry
    integer :: pass = pass_rest
    procedure(card_handler), pointer, nopass :: handle => null() !< null: by the deck reader
  end type keyword_entry

  !> All keywords; `specs(i)` and `entries(i)` belong together.
  type :: keyword_list
    integer :: num_keywords = 0
    type(keyword), allocatable :: specs(:)
    type(keyword_entry), allocatable :: entries(:)
  contains
    procedure :: add
    procedure :: trim => trim_list
  end type keyword_list

  abstract interface
    !> Handles a card that agrees with its specification.
    subroutine card_handler(this, model, faults)
      import :: card, draft, diagnostic_list
      implicit none
      type(card), intent(in) :: this
      type(draft), intent(inout) :: model
      type(diagnostic_list), intent(inout) :: faults
    end subroutine card_handler

    !> Sets the specification of a keyword.
    subroutine spec_maker(spec)
      import :: keyword
      implicit none
      type(keyword), intent(out) :: spec
    end subroutine spec_maker
  end interface

contains

  !> Adds a keyword to the list; without a handler if the deck reader handles its cards.
  subroutine add(self, describe, handle, pass)
    class(keyword_list), intent(inout) :: self
    procedure(spec_maker) :: describe
    procedure(card_handler), optional :: handle
    integer, intent(in), optional :: pass
    type(keyword) :: spec
    call describe(spec)
    self%num_keywords = self%num_keywords + 1
    self%specs(self%num_keywords) = spec
    if (present(pass)) self%entries(self%num_keywords)%pass = pass
    if (present(handle)) self%entries(self%num_keywords)%handle => handle
  end subroutine add

  !> Gives back the unused end of the list.
  subroutine trim_list(self)
    class(keyword_list), intent(inout) :: self
    self%specs = self%specs(:self%num_keywords)
    self%entries = self%entries(:self%num_keywords)
  end subroutine trim_list
end module keyword_handler
