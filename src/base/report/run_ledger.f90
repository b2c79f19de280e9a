!> The ledger of a run: time, memory and calls by part.
!>
!> A part is work on an effect: 'factor' on the 'structure', 'iterate' on a joint, 'write' on 'VTK'.
!> `start` pauses the running part, `stop` resumes it. Each moment of a run belongs to one part, and
!> the times of all parts add up to the time of the run, also in the middle of a step.
!>
!>     call costs%start('factor', 'structure', 'solver')
!>     ...
!>     call costs%stop()
!>
!> Only one thread may start and stop parts.
module run_ledger
  use kinds, only: rk
  use process_limits, only: note_part
  use timer, only: peak_memory, wall_clock
  implicit none
  private
  public :: ledger, ledger_part

  !> Peak memory is read in the first calls of a part, and whenever a part has run this long without
  !> a pause [s], since a reading takes about 50 us. The system provides about 40 MB in 10 ms: at
  !> most so much memory is booked on the wrong part.
  integer, parameter :: num_weighed_calls = 4
  real(rk), parameter :: weighed_time = 0.01_rk

  !> Position of the part that runs while no other part does.
  integer, parameter :: other_part = 1

  !> One line of the ledger.
  type :: ledger_part
    character(:), allocatable :: work !< 'read', 'assemble', 'factor', 'solve', ..
    character(:), allocatable :: effect !< 'structure', name of a joint, a load, a file family, ..
    character(:), allocatable :: kind !< of the effect: 'solver', 'joint', 'load', 'output', ..
    real(rk) :: wall_time = 0.0_rk !< without parts started within this part [s]
    real(rk) :: memory = 0.0_rk !< growth of the peak memory of the process [MB]
    integer :: num_calls = 0 !< calls that have ended
    integer, private :: successor = other_part !< part that followed at the last call
  contains
    procedure :: name => name_of_part
  end type ledger_part

  !> The share of one member in a group of effects.
  type :: effect_share
    character(:), allocatable :: group !< effect that parts are booked on
    character(:), allocatable :: member !< effect that gets the share
    character(:), allocatable :: kind !< of group and member
    real(rk) :: share = 0.0_rk !< shares of a group add up to 1
  end type effect_share

  !> The data that all copies of a ledger share.
  type :: ledger_book
    type(ledger_part), allocatable :: parts(:) !< in the order of their first start
    type(effect_share), allocatable :: shares(:)
    integer, allocatable :: running(:) !< parts that have started, the innermost last
    integer :: depth = 0 !< entries of `running`
    integer :: latest = other_part !< part that was started last
    real(rk) :: opened_at = 0.0_rk !< by the wall clock [s]
    real(rk) :: booked_until = 0.0_rk !< by the wall clock [s]
    real(rk) :: peak = 0.0_rk !< memory that is booked [MB]
  end type ledger_book

  !> A ledger. Copies share their data, so that each solver can keep a copy. A ledger that is not
  !> open records nothing.
  type :: ledger
    type(ledger_book), pointer, private :: book => null()
  contains
    procedure :: open => open_book
    procedure :: start => start_part
    procedure :: stop => stop_part
    procedure :: stop_all
    procedure :: share
    procedure :: read_parts
  end type ledger

contains

  !> Opens the ledger.
  subroutine open_book(self, started_at)
    class(ledger), intent(inout) :: self
    real(rk), intent(in), optional :: started_at !< wall clock [s]; default: now
    integer, parameter :: usual_depth = 32
    allocate (self%book)
    associate (book => self%book)
      allocate (book%parts(0), book%shares(0), book%running(usual_depth))
      book%opened_at = wall_clock()
      if (present(started_at)) book%opened_at = started_at
      book%booked_until = book%opened_at
      call add_part(book%parts, 'other', 'work', 'run')
      book%parts(other_part)%num_calls = 1
      call push(book, other_part)
    end associate
  end subroutine open_book

  !> Starts a part and pauses the running part.
  subroutine start_part(self, work, effect, kind)
    class(ledger), intent(in) :: self
    character(*), intent(in) :: work !< 'read', 'assemble', 'factor', 'solve', ..
    character(*), intent(in) :: effect !< what causes the work
    character(*), intent(in) :: kind !< of the effect
    integer :: part
    if (.not. associated(self%book)) return
    associate (book => self%book)
      part = book%parts(book%latest)%successor
      if (.not. is_part(book%parts(part), work, effect, kind)) then
        call find_or_add(book%parts, work, effect, kind, part)
        book%parts(book%latest)%successor = part
      end if
      book%latest = part
      call book_time(book, book%parts(part)%num_calls < num_weighed_calls)
      call push(book, part)
      call note_part(book%parts(part)%name(), .true.)
    end associate
  end subroutine start_part

  !> Stops the running part and resumes the part around it. With `name`, stops the part of this name
  !> and all parts within it that an error has left running; does nothing if no such part runs.
  subroutine stop_part(self, name)
    class(ledger), intent(in) :: self
    character(*), intent(in), optional :: name !< work and effect: 'factor structure'
    integer :: level
    if (.not. associated(self%book)) return
    associate (book => self%book)
      level = book%depth
      if (present(name)) then
        do level = book%depth, 2, -1
          if (book%parts(book%running(level))%name() == name) exit
        end do
      end if
      if (level > 1) call stop_down_to(book, level)
    end associate
  end subroutine stop_part

  !> Stops all parts, at the end of a run that an error has ended.
  subroutine stop_all(self)
    class(ledger), intent(in) :: self
    if (associated(self%book)) call stop_down_to(self%book, other_part + 1)
  end subroutine stop_all

  !> Declares a group of effects: its parts are divided among the members by weight. A group without
  !> weight stays undivided.
  subroutine share(self, group, kind, members, weights)
    class(ledger), intent(in) :: self
    character(*), intent(in) :: group !< effect that parts are booked on
    character(*), intent(in) :: kind !< of the group and of its members
    character(*), intent(in) :: members(:) !< effects, padded with blanks
    real(rk), intent(in) :: weights(:) !< (members) at least 0
    type(effect_share), allocatable :: longer(:)
    integer :: i, n
    if (.not. associated(self%book)) return
    if (sum(weights) <= 0.0_rk) return
    n = size(self%book%shares)
    allocate (longer(n + size(members)))
    longer(:n) = self%book%shares
    do i = 1, size(members)
      longer(n + i)%group = group
      longer(n + i)%member = trim(members(i))
      longer(n + i)%kind = kind
      longer(n + i)%share = weights(i)/sum(weights)
    end do
    call move_alloc(longer, self%book%shares)
  end subroutine share

  !> All parts as they are now, groups divided among their members. The times add up to `wall_time`.
  subroutine read_parts(self, parts, wall_time)
    class(ledger), intent(in) :: self
    type(ledger_part), allocatable, intent(out) :: parts(:)
    real(rk), intent(out) :: wall_time !< since the ledger was opened [s]
    integer :: i
    allocate (parts(0))
    wall_time = 0.0_rk
    if (.not. associated(self%book)) return
    associate (book => self%book)
      call book_time(book, .true.)
      wall_time = book%booked_until - book%opened_at
      do i = 1, size(book%parts)
        call copy_part(book%parts(i), book%shares, parts)
      end do
    end associate
  end subroutine read_parts

  !> Work and effect: 'factor structure'.
  pure function name_of_part(self) result(name)
    class(ledger_part), intent(in) :: self
    character(:), allocatable :: name
    name = self%work//' '//self%effect
  end function name_of_part

  !> Books the time since the last booking on the running part, and the growth of memory if it is
  !> read.
  subroutine book_time(book, is_weighed)
    type(ledger_book), intent(inout) :: book
    logical, intent(in) :: is_weighed !< read the memory even after a short time
    real(rk) :: now, passed, peak
    now = wall_clock()
    passed = now - book%booked_until
    associate (part => book%parts(book%running(book%depth)))
      part%wall_time = part%wall_time + passed
      if (is_weighed .or. passed > weighed_time) then
        peak = max(peak_memory(), book%peak)
        part%memory = part%memory + (peak - book%peak)
        book%peak = peak
      end if
    end associate
    book%booked_until = now
  end subroutine book_time

  !> Makes a part the running part.
  subroutine push(book, part)
    type(ledger_book), intent(inout) :: book
    integer, intent(in) :: part
    if (book%depth == size(book%running)) book%running = [book%running, book%running]
    book%depth = book%depth + 1
    book%running(book%depth) = part
  end subroutine push

  !> Stops the innermost parts down to the one at `level`.
  subroutine stop_down_to(book, level)
    type(ledger_book), intent(inout) :: book
    integer, intent(in) :: level !< in `running`
    do while (book%depth >= level)
      associate (part => book%running(book%depth))
        call book_time(book, book%parts(part)%num_calls < num_weighed_calls)
        book%parts(part)%num_calls = book%parts(part)%num_calls + 1
      end associate
      book%depth = book%depth - 1
    end do
    if (book%depth > 0) call note_part(book%parts(book%running(book%depth))%name(), .false.)
  end subroutine stop_down_to

  !> Adds a part to a list, or its shares to the parts of the members.
  subroutine copy_part(part, shares, parts)
    type(ledger_part), intent(in) :: part
    type(effect_share), intent(in) :: shares(:)
    type(ledger_part), allocatable, intent(inout) :: parts(:)
    logical :: is_group
    integer :: i
    is_group = .false.
    do i = 1, size(shares)
      if (shares(i)%group /= part%effect .or. shares(i)%kind /= part%kind) cycle
      is_group = .true.
      call add_share(part, shares(i)%member, shares(i)%share, parts)
    end do
    if (.not. is_group) call add_share(part, part%effect, 1.0_rk, parts)
  end subroutine copy_part

  !> Adds a share of a part to the part of the same work on `effect`.
  subroutine add_share(part, effect, share, parts)
    type(ledger_part), intent(in) :: part
    character(*), intent(in) :: effect
    real(rk), intent(in) :: share
    type(ledger_part), allocatable, intent(inout) :: parts(:)
    integer :: i
    call find_or_add(parts, part%work, effect, part%kind, i)
    parts(i)%wall_time = parts(i)%wall_time + share*part%wall_time
    parts(i)%memory = parts(i)%memory + share*part%memory
    parts(i)%num_calls = parts(i)%num_calls + part%num_calls
  end subroutine add_share

  !> Whether a part is this work on this effect.
  pure logical function is_part(part, work, effect, kind)
    type(ledger_part), intent(in) :: part
    character(*), intent(in) :: work, effect, kind
    is_part = part%effect == effect .and. part%work == work .and. part%kind == kind
  end function is_part

  !> Position of a part; a missing part is added.
  subroutine find_or_add(parts, work, effect, kind, part)
    type(ledger_part), allocatable, intent(inout) :: parts(:)
    character(*), intent(in) :: work, effect, kind
    integer, intent(out) :: part
    do part = 1, size(parts)
      if (is_part(parts(part), work, effect, kind)) return
    end do
    call add_part(parts, work, effect, kind)
  end subroutine find_or_add

  !> Adds a part at the end of a list. The array constructor [parts, part] corrupts memory in
  !> gfortran 12 (components of deferred length).
  subroutine add_part(parts, work, effect, kind)
    type(ledger_part), allocatable, intent(inout) :: parts(:)
    character(*), intent(in) :: work, effect, kind
    type(ledger_part), allocatable :: longer(:)
    integer :: n
    n = size(parts)
    allocate (longer(n + 1))
    longer(:n) = parts
    longer(n + 1)%work = work
    longer(n + 1)%effect = effect
    longer(n + 1)%kind = kind
    call move_alloc(longer, parts)
  end subroutine add_part
end module run_ledger
