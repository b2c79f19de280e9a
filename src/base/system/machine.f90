!> What the program runs on: processor, processors that it may use, memory.
module machine
  use kinds, only: rk
  use omp_lib, only: omp_get_num_procs
  implicit none
  private
  public :: processor_name, num_processors, memory_of_machine

  integer, parameter :: longest_line = 256
  real(rk), parameter :: kilobytes_per_megabyte = 1024.0_rk

contains

  !> The name that the processor gives itself; 'unknown' where the system does not say.
  function processor_name() result(name)
    character(:), allocatable :: name
    name = value_in('/proc/cpuinfo', 'model name')
    if (name == '') name = value_in('/proc/cpuinfo', 'Model') ! ARM boards
    if (name == '') name = 'unknown'
  end function processor_name

  !> Logical processors that this process may use.
  integer function num_processors()
    num_processors = omp_get_num_procs()
  end function num_processors

  !> Memory of the machine [MB]; 0 where the system does not say.
  real(rk) function memory_of_machine() result(megabytes)
    character(:), allocatable :: text
    real(rk) :: kilobytes
    integer :: status
    megabytes = 0.0_rk
    text = value_in('/proc/meminfo', 'MemTotal')
    if (text == '') return
    read (text, *, iostat=status) kilobytes
    if (status == 0) megabytes = kilobytes/kilobytes_per_megabyte
  end function memory_of_machine

  !> What stands behind the colon of the first line that begins with a name; '' if there is none.
  function value_in(file, name) result(text)
    character(*), intent(in) :: file, name
    character(:), allocatable :: text
    character(longest_line) :: line
    integer :: unit, status, colon
    text = ''
    open (newunit=unit, file=file, action='read', status='old', iostat=status)
    if (status /= 0) return
    do
      read (unit, '(a)', iostat=status) line
      if (status /= 0) exit
      if (index(line, name) /= 1) cycle
      colon = index(line, ':')
      if (colon == 0) cycle
      text = trim(adjustl(line(colon + 1:)))
      exit
    end do
    close (unit)
  end function value_in
end module machine
