!> A text that grows by many small pieces, for one write to a file.
module text_buffers
  use kinds, only: rk
  implicit none
  private
  public :: text_buffer, text_of

  character(*), parameter :: real_format = '(es20.12e3)' !< 13 significant digits

  type :: text_buffer
    integer :: length = 0
    character(:), allocatable :: room !< the text is room(:length)
  contains
    procedure :: add => add_text
    procedure :: add_real
    procedure :: add_integer
    procedure :: clear
    procedure :: contents
  end type text_buffer

  !> A number as text without blanks.
  interface text_of
    module procedure :: text_of_integer, text_of_real
  end interface text_of

contains

  !> Appends `text` unchanged.
  pure subroutine add_text(self, text)
    class(text_buffer), intent(inout) :: self
    character(*), intent(in) :: text
    character(:), allocatable :: larger
    integer :: needed
    needed = self%length + len(text)
    if (.not. allocated(self%room)) allocate (character(max(4096, needed)) :: self%room)
    if (needed > len(self%room)) then
      allocate (character(max(2*len(self%room), needed)) :: larger)
      larger(:self%length) = self%room(:self%length)
      call move_alloc(larger, self%room)
    end if
    self%room(self%length + 1:needed) = text
    self%length = needed
  end subroutine add_text

  !> Appends a real number, 13 significant digits, no blanks.
  subroutine add_real(self, number)
    class(text_buffer), intent(inout) :: self
    real(rk), intent(in) :: number
    character(20) :: digits
    write (digits, real_format) number
    call self%add(trim(adjustl(digits)))
  end subroutine add_real

  !> Appends an integer without blanks.
  subroutine add_integer(self, number)
    class(text_buffer), intent(inout) :: self
    integer, intent(in) :: number
    character(12) :: digits
    write (digits, '(i0)') number
    call self%add(trim(digits))
  end subroutine add_integer

  !> Empties the text; its memory is kept.
  pure subroutine clear(self)
    class(text_buffer), intent(inout) :: self
    self%length = 0
  end subroutine clear

  !> The whole text.
  pure function contents(self) result(text)
    class(text_buffer), intent(in) :: self
    character(:), allocatable :: text
    text = ''
    if (self%length > 0) text = self%room(:self%length)
  end function contents

  !> '42'
  pure function text_of_integer(number) result(text)
    integer, intent(in) :: number
    character(:), allocatable :: text
    character(12) :: digits
    write (digits, '(i0)') number
    text = trim(digits)
  end function text_of_integer

  !> '4.200000000000E+001'
  pure function text_of_real(number) result(text)
    real(rk), intent(in) :: number
    character(:), allocatable :: text
    character(20) :: digits
    write (digits, real_format) number
    text = trim(adjustl(digits))
  end function text_of_real
end module text_buffers
