!> The contract of a format of archives: store and read named values in groups.
!>
!> The storage keeps its first failure. Later calls do nothing, and `report` returns the failure.
module archive_storage
  use kinds, only: rk
  use errors, only: error_type, raise, raise_unwritten, system_failed
  use write_text, only: as_text
  implicit none
  private
  public :: storage

  type, abstract :: storage
    type(error_type), allocatable, private :: failure !< the first
  contains
    procedure(open_group), deferred :: open_group
    procedure(close_group), deferred :: close_group
    procedure(find), deferred :: find
    procedure(write_absent), deferred :: write_absent
    procedure(write_reals), deferred :: write_reals
    procedure(write_integers), deferred :: write_integers
    procedure(write_text), deferred :: write_text
    procedure(read_reals), deferred :: read_reals
    procedure(read_integers), deferred :: read_integers
    procedure(read_text), deferred :: read_text
    procedure(place_of), deferred :: place_of
    procedure :: fail, fail_to_write
    procedure :: has_failed
    procedure :: report
    procedure :: measure
  end type storage

  abstract interface
    !> Enters a group. The group is made when the archive is being written.
    subroutine open_group(self, name)
      import :: storage
      implicit none
      class(storage), intent(inout) :: self
      character(*), intent(in) :: name !< without '/'
    end subroutine open_group

    !> Leaves the current group for its parent.
    subroutine close_group(self)
      import :: storage
      implicit none
      class(storage), intent(inout) :: self
    end subroutine close_group

    !> Finds a value. A name that the archive does not have is a failure.
    subroutine find(self, name, is_present, extent)
      import :: storage
      implicit none
      class(storage), intent(inout) :: self
      character(*), intent(in) :: name
      logical, intent(out) :: is_present !< false for a component that was not allocated
      integer, allocatable, intent(out) :: extent(:) !< of its dimensions; size 0 for a scalar
    end subroutine find

    !> Stores that a component is not allocated.
    subroutine write_absent(self, name)
      import :: storage
      implicit none
      class(storage), intent(inout) :: self
      character(*), intent(in) :: name
    end subroutine write_absent

    !> Stores reals.
    subroutine write_reals(self, name, extent, values)
      import :: storage, rk
      implicit none
      class(storage), intent(inout) :: self
      character(*), intent(in) :: name
      integer, intent(in) :: extent(:) !< of the dimensions; size 0 for a scalar
      real(rk), intent(in) :: values(product(extent)) !< in the order of memory
    end subroutine write_reals

    !> Stores integers.
    subroutine write_integers(self, name, extent, values)
      import :: storage
      implicit none
      class(storage), intent(inout) :: self
      character(*), intent(in) :: name
      integer, intent(in) :: extent(:) !< of the dimensions; size 0 for a scalar
      integer, intent(in) :: values(product(extent)) !< in the order of memory
    end subroutine write_integers

    !> Stores a text.
    subroutine write_text(self, name, text)
      import :: storage
      implicit none
      class(storage), intent(inout) :: self
      character(*), intent(in) :: name, text
    end subroutine write_text

    !> Reads reals that `find` has found.
    subroutine read_reals(self, name, num_values, values)
      import :: storage, rk
      implicit none
      class(storage), intent(inout) :: self
      character(*), intent(in) :: name
      integer, intent(in) :: num_values
      real(rk), intent(inout) :: values(num_values)
    end subroutine read_reals

    !> Reads integers that `find` has found.
    subroutine read_integers(self, name, num_values, values)
      import :: storage
      implicit none
      class(storage), intent(inout) :: self
      character(*), intent(in) :: name
      integer, intent(in) :: num_values
      integer, intent(inout) :: values(num_values)
    end subroutine read_integers

    !> Reads a text that `find` has found.
    subroutine read_text(self, name, text)
      import :: storage
      implicit none
      class(storage), intent(inout) :: self
      character(*), intent(in) :: name
      character(:), allocatable, intent(inout) :: text
    end subroutine read_text

    !> Archive, group and name, for messages.
    pure function place_of(self, name) result(place)
      import :: storage
      implicit none
      class(storage), intent(in) :: self
      character(*), intent(in) :: name
      character(:), allocatable :: place
    end function place_of
  end interface

contains

  !> Stores a failure, if it is the first one.
  pure subroutine fail(self, message)
    class(storage), intent(inout) :: self
    character(*), intent(in) :: message
    if (.not. allocated(self%failure)) call raise(self%failure, message, system_failed)
  end subroutine fail

  !> Stores the failure of a write, if it is the first one.
  pure subroutine fail_to_write(self, path)
    class(storage), intent(inout) :: self
    character(*), intent(in) :: path
    if (.not. allocated(self%failure)) call raise_unwritten(self%failure, path)
  end subroutine fail_to_write

  !> Whether a call has failed since the last report.
  pure logical function has_failed(self)
    class(storage), intent(in) :: self
    has_failed = allocated(self%failure)
  end function has_failed

  !> Returns the first failure.
  pure subroutine report(self, error)
    class(storage), intent(inout) :: self
    type(error_type), allocatable, intent(out) :: error
    if (allocated(self%failure)) call move_alloc(self%failure, error)
  end subroutine report

  !> Finds an array and compares its extent with the one wanted, or only its rank.
  subroutine measure(self, name, extent, is_present, wanted)
    class(storage), intent(inout) :: self
    character(*), intent(in) :: name
    integer, intent(out) :: extent(:) !< (rank) of the array in the archive
    logical, intent(out) :: is_present
    integer, intent(in), optional :: wanted(:) !< (rank)
    integer, allocatable :: found(:)
    logical :: agrees
    extent = 0
    is_present = .false.
    if (self%has_failed()) return
    call self%find(name, is_present, found)
    is_present = is_present .and. .not. self%has_failed()
    if (.not. is_present) return
    agrees = size(found) == size(extent)
    if (agrees) extent = found
    if (agrees .and. present(wanted)) agrees = all(found == wanted)
    if (agrees) return
    is_present = .false.
    if (.not. present(wanted)) then
      call self%fail(self%place_of(name)//' has '//as_text(size(found))//' dimensions, but '// &
                     as_text(size(extent))//' are expected: the archive is damaged')
    else
      call self%fail(self%place_of(name)//' is an array of '//extent_text(found)//', but of '// &
                     extent_text(wanted)//' in this model: the archive belongs to another model')
    end if
  end subroutine measure

  !> An extent as text: '3 x 120'.
  pure function extent_text(extent) result(text)
    integer, intent(in) :: extent(:)
    character(:), allocatable :: text
    integer :: i
    text = 'one value'
    do i = 1, size(extent)
      if (i == 1) text = as_text(extent(i))
      if (i > 1) text = text//' x '//as_text(extent(i))
    end do
  end function extent_text
end module archive_storage
