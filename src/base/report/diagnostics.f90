!> Faults of the deck: where, what is wrong, what was expected.
!>
!> One list collects all faults while the deck is read; diagnostic_text makes messages of them.
module diagnostics
  use fault_kinds, only: kind_list, shows_reference
  use text_table, only: text_numbers
  use write_text, only: as_text
  implicit none
  private
  public :: place, diagnostic, diagnostic_list, is_shown
  public :: severity_error, severity_warning, severity_ignored

  integer, parameter :: severity_error = 1 !< the deck is wrong
  integer, parameter :: severity_warning = 2 !< the deck is unusual
  integer, parameter :: severity_ignored = 3 !< understood, has no effect here

  !> A spot in the deck.
  type :: place
    character(:), allocatable :: file !< as the user named it
    integer :: line = 0 !< from 1; 0: the file as a whole
    integer :: column = 0 !< from 1, in bytes; 0: the line as a whole
    integer :: length = 0 !< of the word meant, in bytes
    character(:), allocatable :: keyword !< upper case, without the star; '' where there is none
    character(:), allocatable :: source !< the line of the deck
    logical :: is_repeat = .false. !< the line was read before: its places have one remark each
  end type place

  !> One fault or remark.
  type :: diagnostic
    integer :: severity = severity_error
    type(place) :: spot
    character(:), allocatable :: problem !< what is wrong
    character(:), allocatable :: expected !< what was expected, '' for none
    character(:), allocatable :: nearest !< a known word of similar spelling, or ''
    type(place) :: first !< place of an earlier definition; no file: none
    integer :: kind = 0 !< of an error, position in the list of kinds
  end type diagnostic

  !> Everything found in a deck, in the order found.
  type :: diagnostic_list
    integer :: num_errors = 0 !< all, also those beyond the `most_kept` that are kept
    integer :: num_warnings = 0 !< warnings and ignored input
    type(diagnostic), allocatable :: errors(:) !< the first `num_kept` are in use
    type(diagnostic), allocatable :: warnings(:) !< the first `num_warnings` are in use
    type(text_numbers) :: warned !< places and texts of the warnings, in the same order
    integer :: num_kept = 0
    type(kind_list) :: kinds !< of all errors
  contains
    procedure :: add => add_diagnostic
    procedure :: has_errors
  end type diagnostic_list

  character, parameter :: nl = new_line('a')
  integer, parameter :: most_kept = 20 !< errors that are shown (deck.md)

contains

  !> Adds one fault or remark.
  subroutine add_diagnostic(self, severity, spot, problem, expected, nearest, first)
    class(diagnostic_list), intent(inout) :: self
    integer, intent(in) :: severity !< one of the severities above
    type(place), intent(in) :: spot !< where
    character(*), intent(in) :: problem !< what is wrong
    character(*), intent(in), optional :: expected !< what was expected
    character(*), intent(in), optional :: nearest !< a known word of similar spelling
    type(place), intent(in), optional :: first !< where the same was defined before
    type(diagnostic) :: new
    if (is_known(self, severity, spot)) return
    new%severity = severity
    new%spot = spot
    new%problem = problem
    new%expected = ''
    new%nearest = ''
    if (present(expected)) new%expected = expected
    if (present(nearest)) new%nearest = nearest
    if (present(first)) new%first = first
    if (severity == severity_error) then
      self%num_errors = self%num_errors + 1
      call keep_error(self, new)
    else
      call keep_warning(self, new)
    end if
  end subroutine add_diagnostic

  !> Keeps a warning, unless its place has one of the same text.
  subroutine keep_warning(self, new)
    class(diagnostic_list), intent(inout) :: self
    type(diagnostic), intent(in) :: new
    character(:), allocatable :: spot
    integer :: number
    spot = as_text(new%spot%line)//' '//as_text(new%spot%column)//' '
    if (allocated(new%spot%file)) spot = spot//new%spot%file
    call self%warned%find_or_add(spot//nl//new%problem//nl//new%expected, number)
    if (number > self%num_warnings) call append_diagnostic(self%warnings, self%num_warnings, new)
  end subroutine keep_warning

  !> Whether a line that is read several times has a remark at the place.
  pure logical function is_known(self, severity, spot)
    class(diagnostic_list), intent(in) :: self
    integer, intent(in) :: severity
    type(place), intent(in) :: spot
    integer :: i
    is_known = .false.
    if (.not. spot%is_repeat) return
    if (severity == severity_error) then
      do i = 1, self%num_kept
        is_known = is_known .or. is_same_place(self%errors(i)%spot, spot)
      end do
    else
      do i = 1, self%num_warnings
        is_known = is_known .or. is_same_place(self%warnings(i)%spot, spot)
      end do
    end if
  end function is_known

  !> Whether two places have one file, line and column.
  pure logical function is_same_place(a, b)
    type(place), intent(in) :: a, b
    is_same_place = a%line == b%line .and. a%column == b%column
    if (is_same_place) is_same_place = a%file == b%file
  end function is_same_place

  !> Keeps one of the first errors; of missing things only a few, so that their cause, which may be
  !> found later, has a place.
  subroutine keep_error(self, new)
    type(diagnostic_list), intent(inout) :: self
    type(diagnostic), intent(inout) :: new
    character(:), allocatable :: keyword
    logical :: is_kept
    keyword = ''
    if (allocated(new%spot%keyword)) keyword = new%spot%keyword
    call self%kinds%count(keyword, new%problem, new%spot%file, new%kind)
    associate (kind => self%kinds%kinds(new%kind))
      is_kept = self%num_kept < most_kept .and. &
                kind%num <= kind%most_shown
      if (is_kept) call append_diagnostic(self%errors, self%num_kept, new)
      if (is_kept .and. (kind%num == 1 .or. .not. kind%is_reference)) return
    end associate
    call self%kinds%note_line(new%kind, new%spot%line)
  end subroutine keep_error

  !> Whether the next error of a missing thing is shown: the search for a name of similar spelling
  !> takes time where there are many names.
  pure logical function is_shown(faults, problem)
    type(diagnostic_list), intent(in) :: faults
    character(*), intent(in) :: problem !< 'there is no ..'
    is_shown = faults%num_kept < most_kept
    if (is_shown) is_shown = shows_reference(faults%kinds, problem)
  end function is_shown

  !> Whether the deck cannot be run.
  pure logical function has_errors(self)
    class(diagnostic_list), intent(in) :: self
    has_errors = self%num_errors > 0
  end function has_errors

  !> Adds an entry to a growing list.
  subroutine append_diagnostic(list, num_used, new)
    type(diagnostic), allocatable, intent(inout) :: list(:)
    integer, intent(inout) :: num_used !< entries in use
    type(diagnostic), intent(in) :: new
    type(diagnostic), allocatable :: longer(:)
    if (.not. allocated(list)) allocate (list(8))
    if (num_used == size(list)) then
      allocate (longer(2*num_used))
      longer(:num_used) = list
      call move_alloc(longer, list)
    end if
    num_used = num_used + 1
    list(num_used) = new
  end subroutine append_diagnostic
end module diagnostics
