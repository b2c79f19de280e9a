!> What a user can do where an increment has no equilibrium, as the end of the message.
module failure_remedy
  use kinds, only: rk
  use step_plan, only: step
  use joint_points, only: dam_joint
  use step_control, only: increment_control
  use write_text, only: as_text
  implicit none
  private
  public :: name_remedy, name_slave_side

  real(rk), parameter :: much_finer = 1.5_rk !< slave nodes over master nodes of a joint

contains

  !> DIRECT, ITERATIONS or the smallest increment, where one of these ended the step.
  pure function name_remedy(plan, control, iterations) result(text)
    type(step), intent(in) :: plan
    type(increment_control), intent(in) :: control !< after the last reduction
    integer, intent(in) :: iterations !< of the last attempt
    character(:), allocatable :: text
    logical :: needs_more
    text = ''
    needs_more = iterations >= plan%controls%max_iterations
    if (control%is_direct) then
      text = '; the increment is fixed (DIRECT): leave DIRECT out'
      if (needs_more) text = text//', or allow more than '//limit_of(plan)
      return
    end if
    if (needs_more) text = '; allow more than '//limit_of(plan)
    if (control%size >= control%smallest) return
    text = text//'; the smallest increment of the step is '//as_text(control%smallest)//' s: '// &
           'name a smaller one on the data line of *'//trim(plan%procedure%name)
  end function name_remedy

  !> 'ITERATIONS=15 (*CONTROLS)'.
  pure function limit_of(plan) result(text)
    type(step), intent(in) :: plan
    character(:), allocatable :: text
    text = 'ITERATIONS='//as_text(plan%controls%max_iterations)//' (*CONTROLS)'
  end function limit_of

  !> The advice to exchange the sides of a joint whose slave has the finer mesh: the coarser slave
  !> has fewer points, with smoother tractions (different_meshes.md, 13.2).
  pure function name_slave_side(joint) result(text)
    type(dam_joint), intent(in) :: joint
    character(:), allocatable :: text
    logical :: is_master(maxval(joint%node)), is_slave(maxval(joint%node))
    integer :: p
    text = ''
    if (joint%is_matching) return
    is_master = .false.
    is_slave = .false.
    do p = 1, joint%num_points
      is_slave(joint%node(joint%first(p):joint%first_master(p) - 1)) = .true.
      is_master(joint%node(joint%first_master(p):joint%first(p + 1) - 1)) = .true.
    end do
    if (count(is_slave) <= much_finer*count(is_master)) return
    text = ', whose slave has the finer mesh: make the coarser surface the slave'
  end function name_slave_side
end module failure_remedy
