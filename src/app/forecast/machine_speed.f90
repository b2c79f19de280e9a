!> Speed of this machine, measured for a moment and kept for the user: the best of all calls is that
!> of the idle machine.
!>
!> The file is keyway/machine_speed.txt in XDG_CACHE_HOME, or in ~/.cache: for each processor three
!> lines, its name and its two speeds. A file that cannot be read or written is none.
module machine_speed
  use dense_products, only: times
  use errors, only: error_type
  use file_system, only: make_folder
  use kinds, only: rk
  use machine, only: processor_name
  use timer, only: wall_clock
  use whole_files, only: write_whole_file
  use write_text, only: as_text
  implicit none
  private
  public :: speed, find_speeds

  !> What a machine does in a second.
  type :: speed
    real(rk) :: products = 0.0_rk !< of matrices, on one processor [operations/s]
    real(rk) :: sweeps = 0.0_rk !< changing an array that no near cache holds [numbers/s]
  end type speed

  character, parameter :: nl = new_line('a')
  integer, parameter :: longest_line = 300, longest_path = 4096
  integer, parameter :: size_of_product = 384, num_products = 3
  integer, parameter :: size_of_sweep = 2**21, num_sweeps = 5 !< 16 MB
  real(rk), parameter :: shortest = 1.0e-6_rk !< [s]

contains

  !> The speeds now, and the best ones so far, which are stored.
  subroutine find_speeds(now, best)
    type(speed), intent(out) :: now, best
    character(:), allocatable :: folder, name, others
    type(speed) :: stored
    type(error_type), allocatable :: error
    now = speed(speed_of_products(), speed_of_sweeps())
    name = processor_name()
    folder = folder_of_user()
    best = now
    if (folder == '') return
    call read_speeds(folder//'/machine_speed.txt', name, stored, others)
    best = speed(max(now%products, stored%products), max(now%sweeps, stored%sweeps))
    if (best%products <= stored%products .and. best%sweeps <= stored%sweeps) return
    call make_folder(folder, error)
    if (allocated(error)) return
    call write_whole_file(folder//'/machine_speed.txt', name//nl//as_text(best%products)//nl// &
                          as_text(best%sweeps)//nl//others, error)
  end subroutine find_speeds

  !> Where the user's programs keep such files; '' if the system does not say.
  function folder_of_user() result(folder)
    character(:), allocatable :: folder
    character(longest_path) :: place
    integer :: length, status
    folder = ''
    call get_environment_variable('XDG_CACHE_HOME', place, length, status)
    if (status == 0 .and. length > 0) then
      folder = place(:length)//'/keyway'
      return
    end if
    call get_environment_variable('HOME', place, length, status)
    if (status == 0 .and. length > 0) folder = place(:length)//'/.cache/keyway'
  end function folder_of_user

  !> The stored speeds of a processor, and the lines of the others.
  subroutine read_speeds(path, name, stored, others)
    character(*), intent(in) :: path, name
    type(speed), intent(out) :: stored
    character(:), allocatable, intent(out) :: others
    character(longest_line) :: owner, products, sweeps
    integer :: unit, status
    others = ''
    open (newunit=unit, file=path, action='read', status='old', iostat=status)
    if (status /= 0) return
    do
      read (unit, '(a)', iostat=status) owner
      if (status == 0) read (unit, '(a)', iostat=status) products
      if (status == 0) read (unit, '(a)', iostat=status) sweeps
      if (status /= 0) exit
      if (owner == name) then
        stored = speed(number_in(products), number_in(sweeps))
      else
        others = others//trim(owner)//nl//trim(products)//nl//trim(sweeps)//nl
      end if
    end do
    close (unit)
  end subroutine read_speeds

  !> 0 for a damaged line.
  real(rk) function number_in(line) result(number)
    character(*), intent(in) :: line
    integer :: status
    read (line, *, iostat=status) number
    if (status /= 0 .or. .not. number < huge(1.0_rk)) number = 0.0_rk
  end function number_in

  !> The best of some products of matrices [operations/s].
  real(rk) function speed_of_products() result(best)
    real(rk), allocatable :: a(:, :), b(:, :), c(:, :)
    real(rk) :: started_at
    integer :: i
    allocate (a(size_of_product, size_of_product), b(size_of_product, size_of_product), &
              source=1.0_rk)
    allocate (c(size_of_product, size_of_product))
    best = 1.0_rk
    do i = 1, num_products
      started_at = wall_clock()
      c = times(a, b)
      best = max(best, 2.0_rk*real(size_of_product, rk)**3/max(wall_clock() - started_at, shortest))
    end do
  end function speed_of_products

  !> The best of some sweeps over an array [numbers/s].
  real(rk) function speed_of_sweeps() result(best)
    real(rk), allocatable :: numbers(:)
    real(rk) :: started_at
    integer :: i
    allocate (numbers(size_of_sweep), source=1.0_rk)
    best = 1.0_rk
    do i = 1, num_sweeps
      started_at = wall_clock()
      numbers = 0.5_rk*numbers + 1.0_rk
      best = max(best, real(size_of_sweep, rk)/max(wall_clock() - started_at, shortest))
    end do
    if (numbers(1) < 0.0_rk) best = 1.0_rk ! an array that nobody reads would not be computed
  end function speed_of_sweeps
end module machine_speed
