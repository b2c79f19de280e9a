!> A growing list of named sets; members added to an existing name join that set.
module set_lists
  use dam_mesh, only: named_set
  use sorted_lists, only: sorted_unique
  use text_table, only: text_numbers
  implicit none
  private
  public :: set_list

  type :: set_list
    integer :: num_sets = 0
    type(text_numbers), private :: names !< a set's number is its position
    type(named_set), allocatable :: sets(:) !< the first `num_sets` are in use
  contains
    procedure :: find
    procedure :: add => add_members
    procedure :: keep_order
    procedure :: trimmed
  end type set_list

contains

  !> Position of a set, 0 for an unknown name.
  pure integer function find(self, name) result(found)
    class(set_list), intent(in) :: self
    character(*), intent(in) :: name !< upper case
    found = self%names%find(name)
  end function find

  !> Makes a set of some positions, or adds the positions to the set of that name.
  pure subroutine add_members(self, name, members)
    class(set_list), intent(inout) :: self
    character(*), intent(in) :: name !< upper case
    integer, intent(in) :: members(:) !< positions in any order
    integer :: i
    call self%names%find_or_add(name, i)
    if (i <= self%num_sets) then
      self%sets(i)%members = sorted_unique([self%sets(i)%members, members])
      if (allocated(self%sets(i)%in_order)) then
        self%sets(i)%in_order = first_of_each([self%sets(i)%in_order, members])
      end if
      return
    end if
    call double_list(self)
    self%num_sets = self%num_sets + 1
    self%sets(self%num_sets)%name = name
    self%sets(self%num_sets)%members = sorted_unique(members)
  end subroutine add_members

  !> From now on a set keeps the order of its members too: *EQUATION and *MPC pair nodes by it. The
  !> set is made if there is none.
  pure subroutine keep_order(self, name)
    class(set_list), intent(inout) :: self
    character(*), intent(in) :: name !< upper case
    integer :: i
    call self%add(name, [integer ::])
    i = self%names%find(name)
    if (.not. allocated(self%sets(i)%in_order)) self%sets(i)%in_order = self%sets(i)%members
  end subroutine keep_order

  !> The numbers of a list without those that it has had before.
  pure function first_of_each(list) result(firsts)
    integer, intent(in) :: list(:) !< positive
    integer, allocatable :: firsts(:)
    logical :: is_new(size(list)), is_seen(maxval([0, list]))
    integer :: k
    is_seen = .false.
    do k = 1, size(list)
      is_new(k) = .not. is_seen(list(k))
      is_seen(list(k)) = .true.
    end do
    firsts = pack(list, is_new)
  end function first_of_each

  !> The sets in use.
  pure function trimmed(self) result(sets)
    class(set_list), intent(in) :: self
    type(named_set), allocatable :: sets(:)
    allocate (sets(self%num_sets))
    if (self%num_sets > 0) sets = self%sets(:self%num_sets)
  end function trimmed

  !> Doubles the list when it is full; members and their order are moved, not copied.
  pure subroutine double_list(self)
    type(set_list), intent(inout) :: self
    type(named_set), allocatable :: longer(:)
    integer :: i
    if (.not. allocated(self%sets)) allocate (self%sets(8))
    if (self%num_sets < size(self%sets)) return
    allocate (longer(2*self%num_sets))
    do i = 1, self%num_sets
      call move_alloc(self%sets(i)%name, longer(i)%name)
      call move_alloc(self%sets(i)%members, longer(i)%members)
      call move_alloc(self%sets(i)%in_order, longer(i)%in_order)
    end do
    call move_alloc(longer, self%sets)
  end subroutine double_list
end module set_lists
