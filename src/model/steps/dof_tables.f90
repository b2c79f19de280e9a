!> Values at degrees of freedom of nodes that continue from step to step: supports, point forces.
!>
!> A value stays until it is given again (OP=MOD) or all older values are cleared (OP=NEW).
module dof_tables
  use kinds, only: rk
  use node_dofs, only: num_directions, zero_vectors
  use amplitudes, only: amplitude, amplitude_at
  implicit none
  private
  public :: dof_table

  type :: dof_table
    logical, allocatable :: is_set(:, :) !< (3, nodes)
    logical, allocatable :: is_new(:, :) !< given in the step being read
    real(rk), allocatable :: value(:, :) !< at the end of the step
    real(rk), allocatable :: previous(:, :) !< at the end of the step before
    integer, allocatable :: history(:, :) !< amplitude that scales the value, 0 for none
  contains
    procedure :: prepare => allocate_table
    procedure :: put => set_value
    procedure :: add => add_value
    procedure :: clear_old
    procedure :: follows
    procedure :: differs
    procedure :: end_step
  end type dof_table

contains

  !> Allocates the table for a model; existing values stay.
  pure subroutine allocate_table(self, num_nodes)
    class(dof_table), intent(inout) :: self
    integer, intent(in) :: num_nodes
    if (allocated(self%is_set)) return
    allocate (self%is_set(num_directions, num_nodes), source=.false.)
    allocate (self%is_new(num_directions, num_nodes), source=.false.)
    self%value = zero_vectors(num_nodes)
    self%previous = zero_vectors(num_nodes)
    allocate (self%history(num_directions, num_nodes), source=0)
  end subroutine allocate_table

  !> Sets a value; it replaces every earlier one.
  pure subroutine set_value(self, nodes, dof, value, history)
    class(dof_table), intent(inout) :: self
    integer, intent(in) :: nodes(:) !< positions
    integer, intent(in) :: dof !< 1..3
    real(rk), intent(in) :: value
    integer, intent(in) :: history !< position of an amplitude, 0 for none
    integer :: i
    do i = 1, size(nodes)
      self%is_set(dof, nodes(i)) = .true.
      self%is_new(dof, nodes(i)) = .true.
      self%value(dof, nodes(i)) = value
      self%history(dof, nodes(i)) = history
    end do
  end subroutine set_value

  !> Adds to a value of this step under the same amplitude, replaces one of an earlier step.
  pure subroutine add_value(self, nodes, dof, value, history)
    class(dof_table), intent(inout) :: self
    integer, intent(in) :: nodes(:) !< positions
    integer, intent(in) :: dof !< 1..3
    real(rk), intent(in) :: value
    integer, intent(in) :: history !< position of an amplitude, 0 for none
    real(rk) :: sum
    integer :: i
    do i = 1, size(nodes)
      sum = value
      if (self%is_new(dof, nodes(i)) .and. self%history(dof, nodes(i)) == history) then
        sum = sum + self%value(dof, nodes(i))
      end if
      call self%put(nodes(i:i), dof, sum, history)
    end do
  end subroutine add_value

  !> OP=NEW: clears the values of earlier steps.
  pure subroutine clear_old(self)
    class(dof_table), intent(inout) :: self
    where (.not. self%is_new)
      self%is_set = .false.
      self%value = 0.0_rk
      self%history = 0
    end where
  end subroutine clear_old

  !> Which amplitudes scale a value.
  pure function follows(self, num_histories) result(is_followed)
    class(dof_table), intent(in) :: self
    integer, intent(in) :: num_histories
    logical :: is_followed(num_histories)
    integer :: node, dof
    is_followed = .false.
    do node = 1, size(self%history, 2)
      do dof = 1, num_directions
        if (self%history(dof, node) > 0) is_followed(self%history(dof, node)) = .true.
      end do
    end do
  end function follows

  !> Where a degree of freedom is set in one of two tables alone, or to another value. The history
  !> of a value of zero is no matter.
  pure function differs(self, other)
    class(dof_table), intent(in) :: self
    type(dof_table), intent(in) :: other !< of the same nodes
    logical :: differs(size(self%is_set, 1), size(self%is_set, 2))
    differs = (self%is_set .neqv. other%is_set) .or. abs(self%value - other%value) > 0.0_rk &
              .or. (self%history /= other%history .and. abs(self%value) > 0.0_rk)
  end function differs

  !> Ends a step: values that followed an amplitude over step time stay constant from now on.
  pure subroutine end_step(self, histories, step_time, total_time, is_perturbation)
    class(dof_table), intent(inout) :: self
    type(amplitude), intent(in) :: histories(:)
    real(rk), intent(in) :: step_time, total_time !< at the end of the step [s]
    logical, intent(in) :: is_perturbation !< the step does not move the model
    integer :: node, dof
    self%is_new = .false.
    if (is_perturbation) return
    do node = 1, size(self%value, 2)
      do dof = 1, num_directions
        self%previous(dof, node) = self%value(dof, node)
        if (self%history(dof, node) == 0) cycle
        associate (history => histories(self%history(dof, node)))
          if (history%uses_total_time) then
            self%previous(dof, node) = self%value(dof, node)*amplitude_at(history, total_time)
          else
            self%previous(dof, node) = self%value(dof, node)*amplitude_at(history, step_time)
            self%value(dof, node) = self%previous(dof, node)
            self%history(dof, node) = 0
          end if
        end associate
      end do
    end do
  end subroutine end_step
end module dof_tables
