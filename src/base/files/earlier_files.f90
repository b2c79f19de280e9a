!> Removes the files of an earlier run of the same job, so that none is taken for a result of this
!> run. Only files listed in the earlier summary and its numbered VTK files are removed.
module earlier_files
  use file_system, only: file_name
  implicit none
  private
  public :: remove_earlier_files

contains

  !> Removes the files of the earlier run. `stem`: folder and name of the job.
  subroutine remove_earlier_files(stem)
    character(*), intent(in) :: stem
    character(1024) :: line
    logical :: is_in_list
    integer :: unit, status
    call remove_series(stem//'_vtk/'//file_name(stem)//'_')
    call remove_series(stem//'_vtk/'//file_name(stem)//'_joints_')
    open (newunit=unit, file=stem//'.json', status='old', action='read', iostat=status)
    if (status /= 0) return
    is_in_list = .false.
    do
      read (unit, '(a)', iostat=status) line
      if (status /= 0) exit
      if (is_in_list .and. index(line, ']') > 0) exit
      if (is_in_list) call remove_listed(stem, trim(line))
      if (index(line, '"files": [') > 0) is_in_list = .true.
    end do
    close (unit)
  end subroutine remove_earlier_files

  !> Removes PREFIX0001.vtu, PREFIX0002.vtu and so on.
  subroutine remove_series(prefix)
    character(*), intent(in) :: prefix
    character(12) :: digits
    logical :: exists
    integer :: number
    number = 0
    do
      number = number + 1
      write (digits, '(i0.4)') number
      inquire (file=prefix//trim(digits)//'.vtu', exist=exists)
      if (.not. exists) exit
      call remove_file(prefix//trim(digits)//'.vtu')
    end do
  end subroutine remove_series

  !> Removes one entry of the list; a file whose name does not begin with the job's stays.
  subroutine remove_listed(stem, line)
    character(*), intent(in) :: stem
    character(*), intent(in) :: line !< of the summary, '    "dam_energy.csv",'
    character(:), allocatable :: job
    integer :: first, last
    job = file_name(stem)
    first = index(line, '"') + 1
    last = index(line, '"', back=.true.) - 1
    if (last < first) return
    if (index(line(first:last), job) /= 1 .or. index(line, '../') > 0) return
    call remove_file(stem(:len(stem) - len(job))//line(first:last))
  end subroutine remove_listed

  subroutine remove_file(path)
    character(*), intent(in) :: path
    integer :: unit, status
    open (newunit=unit, file=path, status='old', iostat=status)
    if (status == 0) close (unit, status='delete')
  end subroutine remove_file
end module earlier_files
