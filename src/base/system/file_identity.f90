!> Whether two paths name one file, whatever links lead to it.
module file_identity
  use, intrinsic :: iso_c_binding, only: c_char, c_int, c_null_char
  implicit none
  private
  public :: is_same_file, file_path, add_path

  !> A path in a list of paths.
  type :: file_path
    character(:), allocatable :: path
  end type file_path

  interface
    !> Not 0 for one file (system_calls.c).
    function c_is_same_file(first, second) result(answer) bind(c, name='keyway_is_same_file')
      import :: c_char, c_int
      implicit none
      ! allow(assumed-size)
      character(kind=c_char), intent(in) :: first(*), second(*)
      integer(c_int) :: answer
    end function c_is_same_file
  end interface

contains

  !> Adds a path to a list.
  subroutine add_path(paths, path)
    type(file_path), allocatable, intent(inout) :: paths(:)
    character(*), intent(in) :: path
    type(file_path), allocatable :: longer(:)
    integer :: i
    allocate (longer(size(paths) + 1))
    do i = 1, size(paths)
      call move_alloc(paths(i)%path, longer(i)%path)
    end do
    longer(size(longer))%path = path
    call move_alloc(longer, paths)
  end subroutine add_path

  !> True when both exist and are one file.
  logical function is_same_file(first, second)
    character(*), intent(in) :: first, second
    is_same_file = c_is_same_file(first//c_null_char, second//c_null_char) /= 0
  end function is_same_file
end module file_identity
