!> An archive stores values by name, in groups, and returns them bit by bit.
!>
!> All data that change in time are saved with `put` and loaded with `get`, one call for each
!> component. A component that is not allocated is stored as absent and is not allocated after
!> `get`. An array that is allocated before `get` fixes the extent: another extent is a failure.
module archive_type
  use kinds, only: rk
  use write_text, only: as_text
  use archive_storage, only: storage
  implicit none
  private
  public :: archive

  type, abstract, extends(storage) :: archive
  contains
    procedure, private :: put_real, put_reals_1, put_reals_2, put_reals_3
    procedure, private :: put_integer, put_integers_1, put_integers_2, put_integers_3
    procedure, private :: put_logical, put_logicals_1, put_text
    generic :: put => put_real, put_reals_1, put_reals_2, put_reals_3, put_integer, &
      put_integers_1, put_integers_2, put_integers_3, put_logical, put_logicals_1, put_text
    procedure, private :: get_real, get_reals_1, get_reals_2, get_reals_3
    procedure, private :: get_integer, get_integers_1, get_integers_2, get_integers_3
    procedure, private :: get_logical, get_logicals_1, get_text
    generic :: get => get_real, get_reals_1, get_reals_2, get_reals_3, get_integer, &
      get_integers_1, get_integers_2, get_integers_3, get_logical, get_logicals_1, get_text
    procedure :: put_long_text, get_long_text
    procedure :: confirm
  end type archive

contains

  !> Reads a count and compares it with that of the model.
  subroutine confirm(self, name, expected)
    class(archive), intent(inout) :: self
    character(*), intent(in) :: name
    integer, intent(in) :: expected
    integer :: found
    found = expected
    call self%get(name, found)
    if (found == expected) return
    call self%fail(self%place_of(name)//' is '//as_text(found)//', but '//as_text(expected)// &
                   ' in this model: the archive belongs to another model')
  end subroutine confirm

  !> One real.
  subroutine put_real(self, name, value)
    class(archive), intent(inout) :: self
    character(*), intent(in) :: name
    real(rk), intent(in) :: value
    if (self%has_failed()) return
    call self%write_reals(name, [integer ::], [value])
  end subroutine put_real

  !> A list of reals; absent where it is not allocated.
  subroutine put_reals_1(self, name, values)
    class(archive), intent(inout) :: self
    character(*), intent(in) :: name
    real(rk), allocatable, intent(in) :: values(:)
    if (self%has_failed()) return
    if (allocated(values)) then
      call self%write_reals(name, shape(values), values)
    else
      call self%write_absent(name)
    end if
  end subroutine put_reals_1

  !> A table of reals; absent where it is not allocated.
  subroutine put_reals_2(self, name, values)
    class(archive), intent(inout) :: self
    character(*), intent(in) :: name
    real(rk), allocatable, intent(in) :: values(:, :)
    if (self%has_failed()) return
    if (allocated(values)) then
      call self%write_reals(name, shape(values), values)
    else
      call self%write_absent(name)
    end if
  end subroutine put_reals_2

  !> A block of reals; absent where it is not allocated.
  subroutine put_reals_3(self, name, values)
    class(archive), intent(inout) :: self
    character(*), intent(in) :: name
    real(rk), allocatable, intent(in) :: values(:, :, :)
    if (self%has_failed()) return
    if (allocated(values)) then
      call self%write_reals(name, shape(values), values)
    else
      call self%write_absent(name)
    end if
  end subroutine put_reals_3

  !> One integer.
  subroutine put_integer(self, name, value)
    class(archive), intent(inout) :: self
    character(*), intent(in) :: name
    integer, intent(in) :: value
    if (self%has_failed()) return
    call self%write_integers(name, [integer ::], [value])
  end subroutine put_integer

  !> A list of integers; absent where it is not allocated.
  subroutine put_integers_1(self, name, values)
    class(archive), intent(inout) :: self
    character(*), intent(in) :: name
    integer, allocatable, intent(in) :: values(:)
    if (self%has_failed()) return
    if (allocated(values)) then
      call self%write_integers(name, shape(values), values)
    else
      call self%write_absent(name)
    end if
  end subroutine put_integers_1

  !> A table of integers; absent where it is not allocated.
  subroutine put_integers_2(self, name, values)
    class(archive), intent(inout) :: self
    character(*), intent(in) :: name
    integer, allocatable, intent(in) :: values(:, :)
    if (self%has_failed()) return
    if (allocated(values)) then
      call self%write_integers(name, shape(values), values)
    else
      call self%write_absent(name)
    end if
  end subroutine put_integers_2

  !> A block of integers; absent where it is not allocated.
  subroutine put_integers_3(self, name, values)
    class(archive), intent(inout) :: self
    character(*), intent(in) :: name
    integer, allocatable, intent(in) :: values(:, :, :)
    if (self%has_failed()) return
    if (allocated(values)) then
      call self%write_integers(name, shape(values), values)
    else
      call self%write_absent(name)
    end if
  end subroutine put_integers_3

  !> One logical, as 0 or 1.
  subroutine put_logical(self, name, value)
    class(archive), intent(inout) :: self
    character(*), intent(in) :: name
    logical, intent(in) :: value
    call self%put(name, merge(1, 0, value))
  end subroutine put_logical

  !> A list of logicals, as 0 and 1; absent where it is not allocated.
  subroutine put_logicals_1(self, name, values)
    class(archive), intent(inout) :: self
    character(*), intent(in) :: name
    logical, allocatable, intent(in) :: values(:)
    integer, allocatable :: numbers(:)
    if (allocated(values)) numbers = merge(1, 0, values)
    call self%put(name, numbers)
  end subroutine put_logicals_1

  !> A text.
  subroutine put_text(self, name, text)
    class(archive), intent(inout) :: self
    character(*), intent(in) :: name
    character(*), intent(in) :: text
    if (.not. self%has_failed()) call self%write_text(name, text)
  end subroutine put_text

  !> A text of any length, as the numbers of its letters: HDF5 limits the size of a text.
  subroutine put_long_text(self, name, text)
    class(archive), intent(inout) :: self
    character(*), intent(in) :: name
    character(*), intent(in) :: text
    integer, allocatable :: letters(:)
    integer :: i
    letters = [(iachar(text(i:i)), i=1, len(text))]
    call self%put(name, letters)
  end subroutine put_long_text

  !> One real.
  subroutine get_real(self, name, value)
    class(archive), intent(inout) :: self
    character(*), intent(in) :: name
    real(rk), intent(inout) :: value
    real(rk) :: found(1)
    integer :: extent(0)
    logical :: is_present
    found = value
    call self%measure(name, extent, is_present)
    if (is_present) call self%read_reals(name, 1, found)
    value = found(1)
  end subroutine get_real

  !> A list of reals.
  subroutine get_reals_1(self, name, values, extent)
    class(archive), intent(inout) :: self
    character(*), intent(in) :: name
    real(rk), allocatable, intent(inout) :: values(:)
    integer, intent(in), optional :: extent(:) !< wanted
    integer, allocatable :: wanted(:)
    integer :: found(1)
    logical :: is_present
    if (allocated(values)) wanted = shape(values)
    if (present(extent)) wanted = extent
    call self%measure(name, found, is_present, wanted)
    if (self%has_failed()) return
    if (allocated(values)) deallocate (values)
    if (.not. is_present) return
    allocate (values(found(1)))
    call self%read_reals(name, size(values), values)
  end subroutine get_reals_1

  !> A table of reals.
  subroutine get_reals_2(self, name, values, extent)
    class(archive), intent(inout) :: self
    character(*), intent(in) :: name
    real(rk), allocatable, intent(inout) :: values(:, :)
    integer, intent(in), optional :: extent(:) !< wanted
    integer, allocatable :: wanted(:)
    integer :: found(2)
    logical :: is_present
    if (allocated(values)) wanted = shape(values)
    if (present(extent)) wanted = extent
    call self%measure(name, found, is_present, wanted)
    if (self%has_failed()) return
    if (allocated(values)) deallocate (values)
    if (.not. is_present) return
    allocate (values(found(1), found(2)))
    call self%read_reals(name, size(values), values)
  end subroutine get_reals_2

  !> A block of reals.
  subroutine get_reals_3(self, name, values, extent)
    class(archive), intent(inout) :: self
    character(*), intent(in) :: name
    real(rk), allocatable, intent(inout) :: values(:, :, :)
    integer, intent(in), optional :: extent(:) !< wanted
    integer, allocatable :: wanted(:)
    integer :: found(3)
    logical :: is_present
    if (allocated(values)) wanted = shape(values)
    if (present(extent)) wanted = extent
    call self%measure(name, found, is_present, wanted)
    if (self%has_failed()) return
    if (allocated(values)) deallocate (values)
    if (.not. is_present) return
    allocate (values(found(1), found(2), found(3)))
    call self%read_reals(name, size(values), values)
  end subroutine get_reals_3

  !> One integer.
  subroutine get_integer(self, name, value)
    class(archive), intent(inout) :: self
    character(*), intent(in) :: name
    integer, intent(inout) :: value
    integer :: found(1)
    integer :: extent(0)
    logical :: is_present
    found = value
    call self%measure(name, extent, is_present)
    if (is_present) call self%read_integers(name, 1, found)
    value = found(1)
  end subroutine get_integer

  !> A list of integers.
  subroutine get_integers_1(self, name, values, extent)
    class(archive), intent(inout) :: self
    character(*), intent(in) :: name
    integer, allocatable, intent(inout) :: values(:)
    integer, intent(in), optional :: extent(:) !< wanted
    integer, allocatable :: wanted(:)
    integer :: found(1)
    logical :: is_present
    if (allocated(values)) wanted = shape(values)
    if (present(extent)) wanted = extent
    call self%measure(name, found, is_present, wanted)
    if (self%has_failed()) return
    if (allocated(values)) deallocate (values)
    if (.not. is_present) return
    allocate (values(found(1)))
    call self%read_integers(name, size(values), values)
  end subroutine get_integers_1

  !> A table of integers.
  subroutine get_integers_2(self, name, values, extent)
    class(archive), intent(inout) :: self
    character(*), intent(in) :: name
    integer, allocatable, intent(inout) :: values(:, :)
    integer, intent(in), optional :: extent(:) !< wanted
    integer, allocatable :: wanted(:)
    integer :: found(2)
    logical :: is_present
    if (allocated(values)) wanted = shape(values)
    if (present(extent)) wanted = extent
    call self%measure(name, found, is_present, wanted)
    if (self%has_failed()) return
    if (allocated(values)) deallocate (values)
    if (.not. is_present) return
    allocate (values(found(1), found(2)))
    call self%read_integers(name, size(values), values)
  end subroutine get_integers_2

  !> A block of integers.
  subroutine get_integers_3(self, name, values, extent)
    class(archive), intent(inout) :: self
    character(*), intent(in) :: name
    integer, allocatable, intent(inout) :: values(:, :, :)
    integer, intent(in), optional :: extent(:) !< wanted
    integer, allocatable :: wanted(:)
    integer :: found(3)
    logical :: is_present
    if (allocated(values)) wanted = shape(values)
    if (present(extent)) wanted = extent
    call self%measure(name, found, is_present, wanted)
    if (self%has_failed()) return
    if (allocated(values)) deallocate (values)
    if (.not. is_present) return
    allocate (values(found(1), found(2), found(3)))
    call self%read_integers(name, size(values), values)
  end subroutine get_integers_3

  !> One logical.
  subroutine get_logical(self, name, value)
    class(archive), intent(inout) :: self
    character(*), intent(in) :: name
    logical, intent(inout) :: value
    integer :: number
    number = merge(1, 0, value)
    call self%get(name, number)
    value = number /= 0
  end subroutine get_logical

  !> A list of logicals.
  subroutine get_logicals_1(self, name, values, extent)
    class(archive), intent(inout) :: self
    character(*), intent(in) :: name
    logical, allocatable, intent(inout) :: values(:)
    integer, intent(in), optional :: extent(:) !< wanted
    integer, allocatable :: numbers(:)
    if (allocated(values)) numbers = merge(1, 0, values)
    call self%get(name, numbers, extent)
    if (self%has_failed()) return
    if (allocated(values)) deallocate (values)
    if (allocated(numbers)) values = numbers /= 0
  end subroutine get_logicals_1

  !> A text.
  subroutine get_text(self, name, text)
    class(archive), intent(inout) :: self
    character(*), intent(in) :: name
    character(:), allocatable, intent(inout) :: text
    integer :: extent(0)
    logical :: is_present
    call self%measure(name, extent, is_present)
    if (self%has_failed()) return
    if (allocated(text)) deallocate (text)
    if (is_present) call self%read_text(name, text)
  end subroutine get_text

  !> A text of any length.
  subroutine get_long_text(self, name, text)
    class(archive), intent(inout) :: self
    character(*), intent(in) :: name
    character(:), allocatable, intent(out) :: text
    integer, allocatable :: letters(:)
    integer :: i
    call self%get(name, letters)
    text = ''
    if (self%has_failed() .or. .not. allocated(letters)) return
    deallocate (text)
    allocate (character(size(letters)) :: text)
    do i = 1, size(letters)
      text(i:i) = achar(letters(i))
    end do
  end subroutine get_long_text
end module archive_type
