!> The list of a VTK series with times (.pvd), complete at any moment of the run.
module pvd_files
  use kinds, only: rk
  use errors, only: error_type
  use text_buffers, only: text_buffer, text_of
  use archive_type, only: archive
  use earlier_files, only: missing_files
  use whole_files, only: remove_file, write_whole_file
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
    procedure :: save_position
    procedure :: load_position
    procedure :: open_again
    procedure :: note_missing
    procedure, private :: rewrite
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
    call self%rewrite(error)
  end subroutine add_entry

  !> Stores the entries in a checkpoint.
  subroutine save_position(self, file)
    class(pvd_file), intent(in) :: self
    class(archive), intent(inout) :: file !< open for writing
    call file%put_long_text('entries', self%entries%contents())
  end subroutine save_position

  !> Reads the entries from a checkpoint.
  subroutine load_position(self, file)
    class(pvd_file), intent(inout) :: self
    class(archive), intent(inout) :: file !< open for reading
    character(:), allocatable :: entries
    call file%get_long_text('entries', entries)
    call self%entries%clear()
    call self%entries%add(entries)
  end subroutine load_position

  !> Sets the list on the disk back to the entries of the checkpoint; no file without entries.
  subroutine open_again(self, error)
    class(pvd_file), intent(inout) :: self
    type(error_type), allocatable, intent(out) :: error
    if (self%entries%length > 0) then
      call self%rewrite(error)
    else
      call remove_file(self%path)
    end if
  end subroutine open_again

  !> Notes the files of the list that do not exist.
  subroutine note_missing(self, prefix, missing)
    class(pvd_file), intent(in) :: self
    character(*), intent(in) :: prefix !< path of each file up to its number, '.../job_vtk/job_'
    type(missing_files), intent(inout) :: missing
    character(*), parameter :: start = ' file="'
    character(:), allocatable :: text, name
    integer :: first, length
    text = self%entries%contents()
    first = 1
    do
      length = index(text(first:), start)
      if (length == 0) return
      first = first + length - 1 + len(start)
      length = index(text(first:), '"') - 1
      name = text(first:first + length - 1)
      call missing%look_for(prefix//name(index(name, '_', back=.true.) + 1:))
      first = first + length
    end do
  end subroutine note_missing

  !> Writes the list anew.
  subroutine rewrite(self, error)
    class(pvd_file), intent(inout) :: self
    type(error_type), allocatable, intent(out) :: error
    call write_whole_file(self%path, '<?xml version="1.0"?>'//nl//'<VTKFile type="Collection" '// &
                          'version="1.0" byte_order="LittleEndian">'//nl//'<Collection>'//nl// &
                          self%entries%contents()//'</Collection>'//nl//'</VTKFile>'//nl, error)
  end subroutine rewrite

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
