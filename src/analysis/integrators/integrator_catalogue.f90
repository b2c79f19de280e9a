!> The list of integrators: the procedure of the deck, the scheme, the properties of such a step and
!> the maker. Keywords, help and the step loop read this list. A new integrator is a file of its
!> own, and here its `use` and its line in `all_integrators`.
module integrator_catalogue
  use nearest_words, only: nearest_word
  use step_plan, only: step_procedure
  use integrator_type, only: integrator
  use static_integrator, only: make_static
  use hht_integrator, only: make_hht
  use reduced_integrator, only: make_reduced
  use frequency_integrator, only: make_frequency
  implicit none
  private
  public :: procedure_named, is_near_procedure, list_schemes, list_procedures, make_integrator

  abstract interface
    !> Makes an integrator that has no step yet.
    subroutine maker(method)
      import :: integrator
      implicit none
      class(integrator), allocatable, intent(out) :: method
    end subroutine maker
  end interface

  !> One line of the list.
  type :: entry
    type(step_procedure) :: procedure
    procedure(maker), pointer, nopass :: make => null()
  end type entry

contains

  !> The list. The first scheme of a procedure is its default.
  function all_integrators() result(list)
    type(entry), allocatable :: list(:)
    list = [ &
           entry(step_procedure('STATIC', 'NEWTON'), make_static), &
           entry(step_procedure('DYNAMIC', 'HHT', has_inertia=.true., uses_alpha=.true.), &
                 make_hht), &
           entry(step_procedure('DYNAMIC', 'REDUCED', has_inertia=.true., uses_alpha=.true.), &
                 make_reduced), &
           entry(step_procedure('FREQUENCY', 'ARPACK', finds_modes=.true.), make_frequency)]
  end function all_integrators

  !> The procedure of a keyword, with its default scheme or a given one. Its name is empty where the
  !> list has none.
  function procedure_named(name, scheme) result(found)
    character(*), intent(in) :: name !< keyword without its star
    character(*), intent(in), optional :: scheme
    type(step_procedure) :: found
    type(entry), allocatable :: list(:)
    integer :: i
    list = all_integrators()
    do i = 1, size(list)
      if (list(i)%procedure%name /= name) cycle
      if (present(scheme)) then
        if (list(i)%procedure%scheme /= scheme) cycle
      end if
      found = list(i)%procedure
      return
    end do
  end function procedure_named

  !> Whether a keyword is meant for a procedure: a misspelt one, or one with words behind it.
  logical function is_near_procedure(name) result(is_near)
    character(*), intent(in) :: name !< keyword without its star
    type(entry), allocatable :: list(:)
    integer :: i
    list = all_integrators()
    is_near = len(nearest_word(name, list%procedure%name)) > 0
    do i = 1, size(list)
      if (index(name, trim(list(i)%procedure%name)) == 1) is_near = .true.
    end do
  end function is_near_procedure

  !> The schemes of a procedure, as choices of a keyword; the first is the default.
  function list_schemes(name) result(text)
    character(*), intent(in) :: name !< keyword without its star
    character(:), allocatable :: text !< 'A | B'
    type(entry), allocatable :: list(:)
    integer :: i
    list = all_integrators()
    text = ''
    do i = 1, size(list)
      if (list(i)%procedure%name /= name) cycle
      if (len(text) > 0) text = text//' | '
      text = text//trim(list(i)%procedure%scheme)
    end do
  end function list_schemes

  !> All procedures, for messages: '*STATIC, *DYNAMIC or *FREQUENCY'.
  function list_procedures() result(text)
    character(:), allocatable :: text
    type(entry), allocatable :: list(:)
    logical, allocatable :: is_first(:) ! of its name
    integer :: i
    list = all_integrators()
    allocate (is_first(size(list)))
    do i = 1, size(list)
      is_first(i) = .not. any(list(:i - 1)%procedure%name == list(i)%procedure%name)
    end do
    text = '*'//trim(list(1)%procedure%name)
    do i = 2, size(list)
      if (.not. is_first(i)) cycle
      text = text//trim(merge(', *  ', ' or *', any(is_first(i + 1:))))// &
             trim(list(i)%procedure%name)
    end do
  end function list_procedures

  !> The integrator of a step.
  subroutine make_integrator(procedure, method)
    type(step_procedure), intent(in) :: procedure
    class(integrator), allocatable, intent(out) :: method
    type(entry), allocatable :: list(:)
    integer :: i
    list = all_integrators()
    do i = 1, size(list)
      if (list(i)%procedure%name /= procedure%name) cycle
      if (list(i)%procedure%scheme == procedure%scheme) call list(i)%make(method)
    end do
  end subroutine make_integrator
end module integrator_catalogue
