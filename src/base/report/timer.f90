!> Wall clock, memory of the process, and the ledger: what each part of a run costs.
module timer
  use kinds, only: long, rk
  implicit none
  private
  public :: wall_clock, peak_memory, ledger, ledger_part

  real(rk), parameter :: kilobytes_per_megabyte = 1024.0_rk
  !> Calls of a part whose memory is looked at: the first ones take it, and asking costs some 50 us.
  integer, parameter :: num_weighed_calls = 4

  !> One line of the ledger.
  type :: ledger_part
    character(:), allocatable :: name !< 'factorise', 'joint dam', ..
    character(:), allocatable :: kind !< 'deck', 'solver', 'joint', 'load', 'output', ..
    real(rk) :: wall_time = 0.0_rk !< [s]
    real(rk) :: memory = 0.0_rk !< what it added to the most that the process held [MB]
    integer :: num_calls = 0
    logical :: is_running = .false.
    real(rk) :: peak_before = 0.0_rk !< of the process, when it was started [MB]
    real(rk) :: started = 0.0_rk !< by the wall clock [s]
  end type ledger_part

  !> Time, memory and calls by part. Parts come into being when they are first named.
  type :: ledger
    type(ledger_part), allocatable :: parts(:) !< in the order they were first named
  contains
    procedure :: start
    procedure :: stop => stop_part
    procedure :: add_time
    procedure :: add_memory
  end type ledger

contains

  !> Seconds since some fixed instant.
  real(rk) function wall_clock() result(seconds)
    integer(long) :: ticks, rate
    call system_clock(ticks, rate)
    seconds = real(ticks, rk)/real(rate, rk)
  end function wall_clock

  !> Most memory the process has held so far [MB]; 0 where the system does not tell.
  real(rk) function peak_memory() result(megabytes)
    character(*), parameter :: wanted = 'VmHWM:'
    character(256) :: line
    integer :: unit, status
    megabytes = 0.0_rk
    open (newunit=unit, file='/proc/self/status', status='old', action='read', iostat=status)
    if (status /= 0) return
    do
      read (unit, '(a)', iostat=status) line
      if (status /= 0) exit
      if (index(line, wanted) /= 1) cycle
      read (line(len(wanted) + 1:), *, iostat=status) megabytes ! followed by 'kB'
      if (status == 0) megabytes = megabytes/kilobytes_per_megabyte
      exit
    end do
    close (unit)
  end function peak_memory

  !> Starts the clock of a part.
  subroutine start(self, name, kind)
    class(ledger), intent(inout) :: self
    character(*), intent(in) :: name !< of the part
    character(*), intent(in) :: kind !< family it belongs to
    integer :: part
    call find_or_add(self, name, kind, part)
    associate (entry => self%parts(part))
      entry%is_running = .true.
      if (entry%num_calls < num_weighed_calls) entry%peak_before = peak_memory()
      entry%started = wall_clock()
    end associate
  end subroutine start

  !> Stops the clock of a part and counts one call; a part that does not run stays as it is.
  subroutine stop_part(self, name)
    class(ledger), intent(inout) :: self
    character(*), intent(in) :: name !< of the part
    integer :: part
    part = find_part(self, name)
    if (part == 0) return
    associate (entry => self%parts(part))
      if (.not. entry%is_running) return
      entry%wall_time = entry%wall_time + wall_clock() - entry%started
      if (entry%num_calls < num_weighed_calls) then
        entry%memory = entry%memory + peak_memory() - entry%peak_before
      end if
      entry%num_calls = entry%num_calls + 1
      entry%is_running = .false.
    end associate
  end subroutine stop_part

  !> Adds time that was measured elsewhere.
  subroutine add_time(self, name, kind, seconds, num_calls)
    class(ledger), intent(inout) :: self
    character(*), intent(in) :: name !< of the part
    character(*), intent(in) :: kind !< family it belongs to
    real(rk), intent(in) :: seconds
    integer, intent(in) :: num_calls
    integer :: part
    call find_or_add(self, name, kind, part)
    self%parts(part)%wall_time = self%parts(part)%wall_time + seconds
    self%parts(part)%num_calls = self%parts(part)%num_calls + num_calls
  end subroutine add_time

  !> Adds memory that was measured elsewhere.
  subroutine add_memory(self, name, kind, megabytes)
    class(ledger), intent(inout) :: self
    character(*), intent(in) :: name !< of the part
    character(*), intent(in) :: kind !< family it belongs to
    real(rk), intent(in) :: megabytes
    integer :: part
    call find_or_add(self, name, kind, part)
    self%parts(part)%memory = self%parts(part)%memory + megabytes
  end subroutine add_memory

  !> Position of a part, 0 where there is none.
  pure integer function find_part(self, name) result(found)
    class(ledger), intent(in) :: self
    character(*), intent(in) :: name
    integer :: i
    found = 0
    if (.not. allocated(self%parts)) return
    do i = 1, size(self%parts)
      if (self%parts(i)%name == name) found = i
    end do
  end function find_part

  !> Position of a part, which is made where there is none.
  subroutine find_or_add(self, name, kind, part)
    class(ledger), intent(inout) :: self
    character(*), intent(in) :: name, kind
    integer, intent(out) :: part
    type(ledger_part), allocatable :: longer(:)
    part = find_part(self, name)
    if (part > 0) return
    if (.not. allocated(self%parts)) allocate (self%parts(0))
    part = size(self%parts) + 1
    allocate (longer(part))
    longer(:part - 1) = self%parts
    longer(part)%name = name
    longer(part)%kind = kind
    call move_alloc(longer, self%parts)
  end subroutine find_or_add
end module timer
