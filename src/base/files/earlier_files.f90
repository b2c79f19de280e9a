!> Removes the files of an earlier run of the same job, so that none is taken for a result of this
!> run. Only files listed in the earlier summary and its numbered VTK files are removed. A run that
!> goes on keeps them, and notes which are missing.
module earlier_files
  use file_identity, only: file_path, is_same_file
  use file_system, only: file_name
  use errors, only: error_type
  use json_writer, only: quoted
  use whole_files, only: remove_file, write_over, write_whole_file
  implicit none
  private
  public :: remove_earlier_files, remove_series, mark_summary, missing_files

  !> Files of the results that a run which goes on does not find.
  type :: missing_files
    integer :: num_files = 0
    character(:), allocatable :: first !< path of the first one; not allocated without one
  contains
    procedure :: look_for
  end type missing_files

contains

  !> Removes the files of the earlier run. `stem`: folder and name of the job.
  subroutine remove_earlier_files(stem, inputs)
    character(*), intent(in) :: stem
    type(file_path), intent(in) :: inputs(:) !< files that this run reads: they stay
    character(1024) :: line
    logical :: is_in_list
    integer :: unit, status
    call remove_series(stem//'_vtk/'//file_name(stem)//'_', 1)
    call remove_series(stem//'_vtk/'//file_name(stem)//'_joints_', 1)
    open (newunit=unit, file=stem//'.json', status='old', action='read', iostat=status)
    if (status /= 0) return
    is_in_list = .false.
    do
      read (unit, '(a)', iostat=status) line
      if (status /= 0) exit
      if (is_in_list .and. index(line, ']') > 0) exit
      if (is_in_list) call remove_listed(stem, trim(line), inputs)
      if (index(line, '"files": [') > 0) is_in_list = .true.
    end do
    close (unit)
  end subroutine remove_earlier_files

  !> Gives a summary the status "stopped" and a message. On a full disk the summary is written
  !> in its place, where it has room for the message; else it is removed.
  subroutine mark_summary(path, message, only_running)
    character(*), intent(in) :: path
    character(*), intent(in) :: message
    logical, intent(in), optional :: only_running !< a summary with another status stays
    character(:), allocatable :: text
    type(error_type), allocatable :: error
    logical :: is_good
    integer :: unit, num_bytes, status
    open (newunit=unit, file=path, access='stream', form='unformatted', status='old', &
          action='read', iostat=status)
    if (status /= 0) return
    inquire (unit=unit, size=num_bytes)
    allocate (character(num_bytes) :: text)
    read (unit, iostat=status) text
    close (unit)
    if (status /= 0) return
    if (present(only_running)) then
      if (only_running .and. index(text, '"status": "running"') == 0) return
    end if
    text = text(:verify(text, ' '//new_line('a'), back=.true.))//new_line('a')
    call replace_line('"status": ', '"stopped",')
    call replace_line('"message": ', quoted(message)//',')
    call write_whole_file(path, text, error)
    if (.not. allocated(error)) return
    call write_over(path, text, is_good)
    if (.not. is_good) call remove_file(path)

  contains

    !> Replaces what follows a name in its line.
    subroutine replace_line(name, value)
      character(*), intent(in) :: name, value
      integer :: first, length
      first = index(text, name) + len(name)
      if (first == len(name)) return
      length = index(text(first:), new_line('a')) - 1
      if (length < 0) return
      text = text(:first - 1)//value//text(first + length:)
    end subroutine replace_line
  end subroutine mark_summary

  !> Removes PREFIX0001.vtu, PREFIX0002.vtu and so on, from a number on.
  subroutine remove_series(prefix, first)
    character(*), intent(in) :: prefix
    integer, intent(in) :: first !< number
    character(12) :: digits
    logical :: exists
    integer :: number
    number = first - 1
    do
      number = number + 1
      write (digits, '(i0.4)') number
      inquire (file=prefix//trim(digits)//'.vtu', exist=exists)
      if (.not. exists) exit
      call remove_file(prefix//trim(digits)//'.vtu')
    end do
  end subroutine remove_series

  !> Notes a file if it does not exist.
  subroutine look_for(self, path)
    class(missing_files), intent(inout) :: self
    character(*), intent(in) :: path
    logical :: exists
    inquire (file=path, exist=exists)
    if (exists) return
    self%num_files = self%num_files + 1
    if (.not. allocated(self%first)) self%first = path
  end subroutine look_for

  !> Removes one entry of the list; a file whose name does not begin with the job's stays.
  subroutine remove_listed(stem, line, inputs)
    character(*), intent(in) :: stem
    character(*), intent(in) :: line !< of the summary, '    "dam_energy.csv",'
    type(file_path), intent(in) :: inputs(:)
    character(:), allocatable :: job, path
    integer :: first, last, i
    job = file_name(stem)
    first = index(line, '"') + 1
    last = index(line, '"', back=.true.) - 1
    if (last < first) return
    if (index(line(first:last), job) /= 1 .or. index(line, '../') > 0) return
    path = stem(:len(stem) - len(job))//line(first:last)
    do i = 1, size(inputs)
      if (is_same_file(path, inputs(i)%path)) return
    end do
    call remove_file(path)
  end subroutine remove_listed
end module earlier_files
