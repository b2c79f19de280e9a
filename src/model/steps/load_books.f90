!> Which loads are at work, carried from step to step (OP=MOD and OP=NEW of deck.md).
!>
!> A load is known by its family and target (what it acts on, and how). Given again in a later step
!> with the same pattern it only changes its factor; with another pattern the old one fades to
!> nothing while the new one comes in, which is the straight line between the two. Given twice in
!> one step, both act.
module load_books
  use growing_lists, only: make_room
  use kinds, only: rk
  use amplitudes, only: amplitude, amplitude_at
  use step_plan, only: step_load
  use text_table, only: text_numbers
  implicit none
  private
  public :: load_book

  !> One load at work.
  type :: load_at_work
    integer :: load = 0 !< position in the problem's list of loads
    character(:), allocatable :: family, pattern
    integer :: name = 0 !< number of family and target in the book
    integer :: next = 0 !< entry with the same name, 0 for none
    real(rk) :: reached = 0.0_rk !< factor at the end of the step before
    real(rk) :: factor = 0.0_rk !< asked for now
    integer :: history = 0 !< amplitude, 0 for none
    logical :: is_new = .false. !< given in the step being read
    logical :: is_ending = .false. !< fades to nothing in this step
  end type load_at_work

  type :: load_book
    integer :: num_entries = 0
    type(load_at_work), allocatable :: entries(:) !< the first `num_entries` are in use
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

  !> Gives a load anew when its pattern is known already; `load` is 0 when it is not, and older
  !> loads on the same target have been ended.
  pure subroutine take_over(self, family, target, pattern, factor, history, load)
    class(load_book), intent(inout) :: self
    character(*), intent(in) :: family !< its keyword
    character(*), intent(in) :: target !< what it acts on
    character(*), intent(in) :: pattern !< all else that shapes it but the factor
    real(rk), intent(in) :: factor
    integer, intent(in) :: history !< amplitude, 0 for none
    integer, intent(out) :: load !< position in the problem's list, 0: none like it is at work
    integer :: i, name
    load = 0
    name = self%names%find(name_of(family, target))
    if (name == 0) return
    i = self%first(name)
    do while (i > 0)
      associate (old => self%entries(i))
        i = old%next
        if (old%is_new .or. old%is_ending) cycle
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

  !> Enters a load that is new in the problem's list.
  pure subroutine enter(self, family, target, pattern, factor, history, load)
    class(load_book), intent(inout) :: self
    character(*), intent(in) :: family, target, pattern !< as in `take_over`
    real(rk), intent(in) :: factor
    integer, intent(in) :: history !< amplitude, 0 for none
    integer, intent(in) :: load !< position in the problem's list
    type(load_at_work), allocatable :: longer(:)
    if (.not. allocated(self%entries)) allocate (self%entries(8))
    if (self%num_entries == size(self%entries)) then
      allocate (longer(2*self%num_entries))
      longer(:self%num_entries) = self%entries
      call move_alloc(longer, self%entries)
    end if
    self%num_entries = self%num_entries + 1
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

  !> One text for a family and a target.
  pure function name_of(family, target) result(name)
    character(*), intent(in) :: family, target
    character(:), allocatable :: name
    name = family//new_line('a')//target
  end function name_of

  !> Puts an entry behind those with its name.
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

  !> OP=NEW: what earlier steps have given of this family fades to nothing.
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

  !> A load of this family goes on at the last value of a history that has ended.
  pure logical function holds(self, family)
    class(load_book), intent(in) :: self
    character(*), intent(in) :: family !< its keyword
    integer :: i
    holds = .false.
    do i = 1, self%num_entries
      associate (now => self%entries(i))
        holds = holds .or. now%family == family .and. now%history == 0 .and. &
                abs(now%reached) > 0.0_rk
      end associate
    end do
  end function holds

  !> All loads at work in the step being read.
  pure function loads_of_step(self) result(loads)
    class(load_book), intent(in) :: self
    type(step_load), allocatable :: loads(:)
    integer :: i, used
    allocate (loads(self%num_entries))
    used = 0
    do i = 1, self%num_entries
      associate (now => self%entries(i))
        if (now%is_ending .and. abs(now%reached) <= 0.0_rk) cycle
        used = used + 1
        loads(used)%load = now%load
        loads(used)%start_factor = now%reached
        loads(used)%end_factor = merge(0.0_rk, now%factor, now%is_ending)
        loads(used)%amplitude = merge(0, now%history, now%is_ending)
      end associate
    end do
    loads = loads(:used)
  end function loads_of_step

  !> Closes a step. A load that followed an amplitude over the step's time is held from now on.
  pure subroutine end_step(self, histories, step_time, total_time, is_perturbation)
    class(load_book), intent(inout) :: self
    type(amplitude), intent(in) :: histories(:)
    real(rk), intent(in) :: step_time, total_time !< at the end of the step [s]
    logical, intent(in) :: is_perturbation !< the step does not move the model
    integer :: i, used
    if (.not. allocated(self%entries)) return
    self%entries%is_new = .false.
    if (is_perturbation) return
    used = 0
    self%first(:self%num_names) = 0
    do i = 1, self%num_entries
      if (self%entries(i)%is_ending) cycle
      used = used + 1
      if (used < i) self%entries(used) = self%entries(i)
      call list_by_name(self, used)
      call reach_end(self%entries(used), histories, step_time, total_time)
    end do
    self%num_entries = used
  end subroutine end_step

  pure subroutine reach_end(now, histories, step_time, total_time)
    type(load_at_work), intent(inout) :: now
    type(amplitude), intent(in) :: histories(:)
    real(rk), intent(in) :: step_time, total_time
    now%reached = now%factor
    if (now%history == 0) return
    if (histories(now%history)%uses_total_time) then
      now%reached = now%factor*amplitude_at(histories(now%history), total_time)
    else
      now%reached = now%factor*amplitude_at(histories(now%history), step_time)
      now%factor = now%reached
      now%history = 0
    end if
  end subroutine reach_end
end module load_books
