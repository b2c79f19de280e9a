!> Which elements there are in each step (*MODEL CHANGE), and which joints are grouted (*GROUT).
module stage_plan
  implicit none
  private
  public :: stages, classes_of

  !> Nothing is allocated in a deck without these keywords.
  type :: stages
    logical, allocatable :: is_absent(:, :) !< (elements, steps)
    integer, allocatable :: material(:) !< (elements) of the complete model
    logical, allocatable :: is_grouted(:) !< (joints) has a *GROUT in some step
  contains
    procedure :: is_there_any
    procedure :: has_element
    procedure :: changes_elements
    procedure :: step_of_elements
  end type stages

contains

  !> Whether the deck has stages.
  pure logical function is_there_any(self)
    class(stages), intent(in) :: self
    is_there_any = allocated(self%is_absent) .or. allocated(self%is_grouted)
  end function is_there_any

  !> Whether an element is there in a step.
  pure logical function has_element(self, element, step)
    class(stages), intent(in) :: self
    integer, intent(in) :: element !< position
    integer, intent(in) :: step !< number of the step
    has_element = .true.
    if (allocated(self%is_absent)) has_element = .not. self%is_absent(element, step)
  end function has_element

  !> Whether elements come or go at the start of a step.
  pure logical function changes_elements(self, step)
    class(stages), intent(in) :: self
    integer, intent(in) :: step !< number of the step
    changes_elements = .false.
    if (.not. allocated(self%is_absent)) return
    if (step == 1) then
      changes_elements = any(self%is_absent(:, 1))
    else
      changes_elements = any(self%is_absent(:, step) .neqv. self%is_absent(:, step - 1))
    end if
  end function changes_elements

  !> The step in which each element was added, 1 where it has been there since the first, 0 where it
  !> is absent. The deck has *MODEL CHANGE.
  pure function step_of_elements(self, step) result(added)
    class(stages), intent(in) :: self
    integer, intent(in) :: step !< the present one
    integer :: added(size(self%is_absent, 1))
    integer :: s
    added = 0
    do s = 1, step
      added = merge(0, merge(s, added, added == 0), self%is_absent(:, s))
    end do
  end function step_of_elements

  !> Numbers the elements so that those of one number come and go together.
  pure function classes_of(is_absent) result(class_of)
    logical, intent(in) :: is_absent(:, :) !< (elements, steps)
    integer :: class_of(size(is_absent, 1))
    integer :: first(2*size(is_absent, 1) + 1), s, e, key, num_classes
    class_of = 1
    do s = 1, size(is_absent, 2)
      first = 0
      num_classes = 0
      do e = 1, size(class_of)
        key = 2*class_of(e) - merge(1, 0, is_absent(e, s))
        if (first(key) == 0) then
          num_classes = num_classes + 1
          first(key) = num_classes
        end if
        class_of(e) = first(key)
      end do
    end do
  end function classes_of
end module stage_plan
