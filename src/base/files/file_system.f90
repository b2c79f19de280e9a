!> Folders and names of files.
module file_system
  use, intrinsic :: iso_c_binding, only: c_char, c_int, c_null_char
  use errors, only: deck_is_wrong, error_type, raise, system_failed
  implicit none
  private
  public :: make_folder, safe_name, link_name, file_name, base_name

  interface
    !> POSIX mkdir.
    function c_mkdir(path, mode) bind(c, name='mkdir') result(status)
      import :: c_char, c_int
      implicit none
      ! allow(assumed-size)
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int), value :: mode
      integer(c_int) :: status
    end function c_mkdir
  end interface

  integer, parameter :: mode_of_folders = int(o'755')

contains

  !> Makes a folder and its parents; a folder that exists is no error. A file in its place is an
  !> error of the command line, not of the system.
  subroutine make_folder(path, error)
    character(*), intent(in) :: path
    type(error_type), allocatable, intent(out) :: error
    character(300) :: reason
    integer :: i, unit, status, status_of_removal
    do i = 2, len(path)
      if (path(i:i) == '/') status = c_mkdir(path(:i - 1)//c_null_char, int(mode_of_folders, c_int))
    end do
    status = c_mkdir(path//c_null_char, int(mode_of_folders, c_int))
    open (newunit=unit, file=path//'/.keyway_probe', status='replace', iostat=status, &
          iomsg=reason)
    if (status == 0) then
      ! Another run that starts in the folder may have removed the file already.
      close (unit, status='delete', iostat=status_of_removal)
      if (status_of_removal /= 0) close (unit)
      return
    end if
    if (index(reason, 'Not a directory') > 0) then
      call raise(error, "cannot write in the folder '"//path//"': a file has this name, or "// &
                 'that of a folder above; expected another name (-o)', deck_is_wrong)
      return
    end if
    call raise(error, "cannot write in the folder '"//path//"'"// &
               trim(reason(max(1, index(reason, ': ', back=.true.)):)), system_failed)
    error%is_of_disk = .true.
  end subroutine make_folder

  !> The name with all but letters, digits, '_', '-' and '.' turned to '_', for names of files.
  pure function safe_name(name) result(safe)
    character(*), intent(in) :: name
    character(len(name)) :: safe
    integer :: i
    do i = 1, len(name)
      select case (name(i:i))
      case ('A':'Z', 'a':'z', '0':'9', '_', '-', '.')
        safe(i:i) = name(i:i)
      case default
        safe(i:i) = '_'
      end select
    end do
  end function safe_name

  !> The name with '/' turned to '_', for paths in an HDF5 file.
  pure function link_name(name) result(safe)
    character(*), intent(in) :: name
    character(len(name)) :: safe
    integer :: i
    safe = name
    do i = 1, len(name)
      if (name(i:i) == '/') safe(i:i) = '_'
    end do
  end function link_name

  !> The name of a file without its folder.
  pure function file_name(path) result(name)
    character(*), intent(in) :: path
    character(:), allocatable :: name
    name = path(index(path, '/', back=.true.) + 1:)
  end function file_name

  !> The name of a file without its folder and its ending: the job's name.
  pure function base_name(path) result(name)
    character(*), intent(in) :: path
    character(:), allocatable :: name
    integer :: dot
    name = file_name(path)
    dot = index(name, '.', back=.true.)
    if (dot > 1) name = name(:dot - 1)
  end function base_name
end module file_system
