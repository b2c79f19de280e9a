!> Other words in place of words of a card. The places in the deck stay those of the user's words.
module card_rewrite
  use deck_card, only: card, card_parameter
  use text_buffers, only: text_buffer
  implicit none
  private
  public :: card_rewriter

  !> Collects new words; `finish` puts them into the card.
  type :: card_rewriter
    private
    type(text_buffer) :: words !< new words, one after the other
    integer :: old_length = 0 !< bytes of the card
    logical :: has_fields = .false. !< a field has a new word
  contains
    procedure :: begin
    procedure :: put_field
    procedure :: put_value
    procedure :: add_parameter
    procedure :: finish
  end type card_rewriter

contains

  subroutine begin(self, this)
    class(card_rewriter), intent(inout) :: self
    type(card), intent(in) :: this
    call self%words%clear()
    self%old_length = len(this%lines%body)
    self%has_fields = .false.
  end subroutine begin

  !> Gives a field that is not missing another word.
  subroutine put_field(self, this, line, field, word)
    class(card_rewriter), intent(inout) :: self
    type(card), intent(inout) :: this
    integer, intent(in) :: line, field
    character(*), intent(in) :: word
    integer :: i
    i = this%lines%position_of(line, field)
    if (i == 0) return
    if (.not. self%has_fields .and. .not. allocated(this%lines%read_first)) then
      this%lines%read_first = this%lines%field_first
      this%lines%read_last = this%lines%field_last
    end if
    self%has_fields = .true.
    call append_word(self, word, this%lines%read_first(i), this%lines%read_last(i))
  end subroutine put_field

  !> Gives a parameter another value.
  subroutine put_value(self, this, parameter, word)
    class(card_rewriter), intent(inout) :: self
    type(card), intent(inout) :: this
    integer, intent(in) :: parameter !< its position
    character(*), intent(in) :: word
    associate (given => this%parameters(parameter))
      call append_word(self, word, given%read_first, given%read_last)
    end associate
  end subroutine put_value

  !> Adds a parameter, whose place is the keyword.
  subroutine add_parameter(self, this, name, word)
    class(card_rewriter), intent(inout) :: self
    type(card), intent(inout) :: this
    character(*), intent(in) :: name !< upper case
    character(*), intent(in) :: word !< its value
    type(card_parameter) :: new
    new%name = name
    new%has_value = .true.
    new%first = this%lines%rows(1)%first
    new%last = new%first + len(this%keyword)
    new%value_first = new%first
    new%value_last = new%last
    call append_word(self, word, new%read_first, new%read_last)
    this%parameters = [this%parameters, new]
  end subroutine add_parameter

  !> Puts the new words at the end of the text of the card.
  subroutine finish(self, this)
    class(card_rewriter), intent(inout) :: self
    type(card), intent(inout) :: this
    if (self%words%length > 0) this%lines%body = this%lines%body//self%words%contents()
  end subroutine finish

  subroutine append_word(self, word, first, last)
    class(card_rewriter), intent(inout) :: self
    character(*), intent(in) :: word
    integer, intent(out) :: first, last !< its bytes in the card
    first = self%old_length + self%words%length + 1
    call self%words%add(word)
    last = self%old_length + self%words%length
  end subroutine append_word
end module card_rewrite
