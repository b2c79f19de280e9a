!> The active loads, which continue from step to step (OP=MOD and OP=NEW of deck.md).
!>
!> Family and target (what the load acts on, and how) identify a load. A load given again in a later
!> step with the same pattern changes its factor. With another pattern the old load fades to zero
!> while the new one grows, which is linear interpolation between the two; where the new one follows
!> an amplitude, the old one ends at once. Two loads given in one step both act.
module load_books
  use growing_lists, only: make_room
  use kinds, only: rk
  use amplitudes, only: amplitude, amplitude_at
  use step_plan, only: step_load
  use text_table, only: text_numbers
  implicit none
  private
  public :: load_book

  !> One active load.
  type :: active_load
    integer :: load = 0 !< position in the problem's list of loads
    character(:), allocatable :: family, pattern
    integer :: name = 0 !< number of family and target in the book
    integer :: next = 0 !< entry with the same name, 0 for none
    real(rk) :: previous = 0.0_rk !< factor at the end of the step before
    real(rk) :: factor = 0.0_rk !< factor that the deck gives last
    integer :: history = 0 !< amplitude, 0 for none
    logical :: is_new = .false. !< given in the step being read
    logical :: is_ending = .false. !< fades to zero in this step
    logical :: is_replaced = .false. !< by a load with an amplitude: ends at once
  end type active_load

  type :: load_book
    integer :: num_entries = 0
    type(active_load), allocatable :: entries(:) !< the first `num_entries` are in use
    type(text_numbers), private :: names !< of family and target
    integer, private :: num_names = 0
    integer, allocatable, private :: first(:), last(:) !< (names) entries, 0 for none
  contains
    procedure :: take_over
    procedure :: enter
    procedure :: clear_old
    procedure :: holds
    procedure :: loads_of_step
    procedure :: end_step
  end type load_book

contains

  !> Gives an active load of the same pattern a new factor. Without one, `load` is 0, and older
  !> loads on the same target end in this step.
  pure subroutine take_over(self, family, target, pattern, factor, history, load)
    class(load_book), intent(inout) :: self
    character(*), intent(in) :: family !< its keyword
    character(*), intent(in) :: target !< what the load acts on
    character(*), intent(in) :: pattern !< all other data of the load but the factor
    real(rk), intent(in) :: factor
    integer, intent(in) :: history !< amplitude, 0 for none
    integer, intent(out) :: load !< position in the problem's list, 0 for none
    integer :: i, name
    load = 0
    name = self%names%find(name_of(family, target))
    if (name == 0) return
    i = self%first(name)
    do while (i > 0)
      associate (old => self%entries(i))
        i = old%next
        if (old%is_new) cycle
        old%is_replaced = history > 0
        if (old%is_ending) cycle
        if (load == 0 .and. old%pattern == pattern) then
          load = old%load
          old%factor = factor
          old%history = history
          old%is_new = .true.
        else
          old%is_ending = .true.
        end if
      end associate
    end do
  end subroutine take_over

  !> Adds a new load of the problem's list.
  pure subroutine enter(self, family, target, pattern, factor, history, load)
    class(load_book), intent(inout) :: self
    character(*), intent(in) :: family, target, pattern !< as in `take_over`
    real(rk), intent(in) :: factor
    integer, intent(in) :: history !< amplitude, 0 for none
    integer, intent(in) :: load !< position in the problem's list
    type(active_load), allocatable :: longer(:)
    if (.not. allocated(self%entries)) allocate (self%entries(8))
    if (self%num_entries == size(self%entries)) then
      allocate (longer(2*self%num_entries))
      longer(:self%num_entries) = self%entries
      call move_alloc(longer, self%entries)
    end if
    self%num_entries = self%num_entries + 1
    self%entries(self%num_entries) = active_load() ! the place may have been that of a cleared load
    associate (new => self%entries(self%num_entries))
      new%load = load
      new%family = family
      new%pattern = pattern
      call self%names%find_or_add(name_of(family, target), new%name)
      new%factor = factor
      new%history = history
      new%is_new = .true.
    end associate
    call list_by_name(self, self%num_entries)
  end subroutine enter

  !> The text that identifies a family and a target.
  pure function name_of(family, target) result(name)
    character(*), intent(in) :: family, target
    character(:), allocatable :: name
    name = family//new_line('a')//target
  end function name_of

  !> Adds an entry after those of the same name.
  pure subroutine list_by_name(self, entry)
    type(load_book), intent(inout) :: self
    integer, intent(in) :: entry
    integer :: name
    name = self%entries(entry)%name
    self%entries(entry)%next = 0
    if (name > self%num_names) then
      call make_room(self%first, self%num_names, 1)
      call make_room(self%last, self%num_names, 1)
      self%num_names = name
      self%first(name) = 0
    end if
    if (self%first(name) == 0) then
      self%first(name) = entry
    else
      self%entries(self%last(name))%next = entry
    end if
    self%last(name) = entry
  end subroutine list_by_name

  !> OP=NEW: loads of this family from earlier steps fade to zero.
  pure subroutine clear_old(self, family)
    class(load_book), intent(inout) :: self
    character(*), intent(in) :: family !< its keyword
    integer :: i
    do i = 1, self%num_entries
      if (self%entries(i)%family == family .and. .not. self%entries(i)%is_new) then
        self%entries(i)%is_ending = .true.
      end if
    end do
  end subroutine clear_old

  !> Whether a load of this family keeps the last value of a history that has ended.
  pure logical function holds(self, family)
    class(load_book), intent(in) :: self
    character(*), intent(in) :: family !< its keyword
    integer :: i
    holds = .false.
    do i = 1, self%num_entries
      associate (now => self%entries(i))
        holds = holds .or. now%family == family .and. now%history == 0 .and. &
                abs(now%previous) > 0.0_rk
      end associate
    end do
  end function holds

  !> All loads that are active in the step being read.
  pure function loads_of_step(self) result(loads)
    class(load_book), intent(in) :: self
    type(step_load), allocatable :: loads(:)
    integer :: i, used
    allocate (loads(self%num_entries))
    used = 0
    do i = 1, self%num_entries
      associate (now => self%entries(i))
        if (now%is_ending .and. (now%is_replaced .or. abs(now%previous) <= 0.0_rk)) cycle
        used = used + 1
        loads(used)%load = now%load
        loads(used)%start_factor = now%previous
        loads(used)%end_factor = merge(0.0_rk, now%factor, now%is_ending)
        loads(used)%amplitude = merge(0, now%history, now%is_ending)
      end associate
    end do
    loads = loads(:used)
  end function loads_of_step

  !> Ends a step. A load that followed an amplitude over step time stays constant from now on.
  pure subroutine end_step(self, histories, step_time, total_time, is_perturbation)
    class(load_book), intent(inout) :: self
    type(amplitude), intent(in) :: histories(:)
    real(rk), intent(in) :: step_time, total_time !< at the end of the step [s]
    logical, intent(in) :: is_perturbation !< the step does not move the model
    integer :: i, used
    if (.not. allocated(self%entries)) return
    self%entries%is_new = .false.
    if (is_perturbation) return
    self%entries%is_replaced = .false.
    used = 0
    self%first(:self%num_names) = 0
    do i = 1, self%num_entries
      if (self%entries(i)%is_ending) cycle
      used = used + 1
      if (used < i) self%entries(used) = self%entries(i)
      call list_by_name(self, used)
      call hold_last_value(self%entries(used), histories, step_time, total_time)
    end do
    self%num_entries = used
  end subroutine end_step

  pure subroutine hold_last_value(now, histories, step_time, total_time)
    type(active_load), intent(inout) :: now
    type(amplitude), intent(in) :: histories(:)
    real(rk), intent(in) :: step_time, total_time
    now%previous = now%factor
    if (now%history == 0) return
    if (histories(now%history)%uses_total_time) then
      now%previous = now%factor*amplitude_at(histories(now%history), total_time)
    else
      now%previous = now%factor*amplitude_at(histories(now%history), step_time)
      now%factor = now%previous
      now%history = 0
    end if
  end subroutine hold_last_value
end module load_books
