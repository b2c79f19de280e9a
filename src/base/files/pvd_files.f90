!> The list of a VTK series with times (.pvd), complete at any moment of the run.
module pvd_files
  use kinds, only: rk
  use errors, only: error_type
  use text_buffers, only: text_buffer, text_of
  use whole_files, only: write_whole_file
  implicit none
  private
  public :: pvd_file, frame_name

  character, parameter :: nl = new_line('a')

  type :: pvd_file
    private
    character(:), allocatable :: path
    character(:), allocatable :: folder !< of the listed files, relative to this one
    type(text_buffer) :: entries
  contains
    procedure :: open => open_pvd
    procedure :: add => add_entry
  end type pvd_file

contains

  !> Opens the list; the file is written with its first entry.
  subroutine open_pvd(self, path, folder)
    class(pvd_file), intent(inout) :: self
    character(*), intent(in) :: path
    character(*), intent(in) :: folder
    self%path = path
    self%folder = folder
  end subroutine open_pvd

  !> Adds a file and rewrites the list.
  subroutine add_entry(self, time, name, error)
    class(pvd_file), intent(inout) :: self
    real(rk), intent(in) :: time !< total time [s]
    character(*), intent(in) :: name
    type(error_type), allocatable, intent(out) :: error
    call self%entries%add('<DataSet timestep="'//text_of(time)//'" part="0" file="'// &
                          escaped(self%folder//name)//'"/>'//nl)
    call write_whole_file(self%path, '<?xml version="1.0"?>'//nl//'<VTKFile type="Collection" '// &
                          'version="1.0" byte_order="LittleEndian">'//nl//'<Collection>'//nl// &
                          self%entries%contents()//'</Collection>'//nl//'</VTKFile>'//nl, error)
  end subroutine add_entry

  !> A text as the value of an XML attribute.
  pure function escaped(text) result(safe)
    character(*), intent(in) :: text
    character(:), allocatable :: safe
    integer :: i
    safe = ''
    do i = 1, len(text)
      select case (text(i:i))
      case ('&')
        safe = safe//'&amp;'
      case ('<')
        safe = safe//'&lt;'
      case ('"')
        safe = safe//'&quot;'
      case default
        safe = safe//text(i:i)
      end select
    end do
  end function escaped

  !> 'job_0001.vtu'
  pure function frame_name(stem, number) result(name)
    character(*), intent(in) :: stem
    integer, intent(in) :: number
    character(:), allocatable :: name
    character(12) :: digits
    write (digits, '(i4.4)') number
    if (number > 9999) write (digits, '(i0)') number
    name = stem//'_'//trim(digits)//'.vtu'
  end function frame_name
end module pvd_files
