!> Sizes of increments: growth, cuts, and sizes that follow an error.
program test_step_control
  use kinds, only: rk
  use step_control, only: increment_control, start_control
  use step_plan, only: step
  use testing, only: test_log, check, check_close
  implicit none

  type(test_log) :: log

  log%suite = 'step_control'
  call increments_grow_and_shrink(log)
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Halves after failure, gives up at the smallest size; the end is met without a sliver.
  subroutine increments_grow_and_shrink(log)
    type(test_log), intent(inout) :: log
    type(step) :: plan
    type(increment_control) :: control
    logical :: gives_up
    integer :: i
    plan%first_increment = 0.1_rk
    plan%duration = 1.0_rk
    call start_control(plan, .false., control)
    call control%accept(3)
    call control%accept(3)
    call check_close(log, control%size, 0.15_rk, 1.0e-15_rk, 'grown after two easy increments')
    call control%cut(0.15_rk, 1.0_rk, gives_up)
    call check_close(log, control%size, 0.075_rk, 1.0e-15_rk, 'halved')
    call check(log,.not. gives_up, 'goes on')
    call slow_increments_grow(log, plan)
    plan%first_increment = 0.01_rk
    call start_control(plan, .true., control)
    do i = 1, 40
      call control%accept(3)
    end do
    call check_close(log, control%size, 0.01_rk, 1.0e-15_rk, 'dynamic increments do not grow')
    call check_close(log, control%next_size(0.99_rk + 1.0e-14_rk), 0.01_rk, 0.0_rk, 'no sliver')
    call control%cut(0.01_rk, 1.0_rk, gives_up)
    call check_close(log, control%size, 0.005_rk, 1.0e-15_rk, 'dynamic increments are halved')
    do i = 1, 10
      call control%accept(3)
    end do
    call check_close(log, control%size, 0.01_rk, 1.0e-15_rk, 'and doubled again')
    call follow_an_error(log, plan)
    call cut_to_the_smallest(log, plan)
    plan%is_direct = .true.
    call start_control(plan, .true., control)
    call control%cut(0.01_rk, 1.0_rk, gives_up)
    call check(log, gives_up, 'direct increments are not cut')
  end subroutine increments_grow_and_shrink

  !> A smallest increment of the deck is met, however many cuts that takes: 0.01 s to 1e-8 s.
  subroutine cut_to_the_smallest(log, plan)
    type(test_log), intent(inout) :: log
    type(step), intent(in) :: plan
    type(step) :: named
    type(increment_control) :: control
    logical :: gives_up
    integer :: num_cuts
    named = plan
    named%smallest_increment = 1.0e-8_rk
    call start_control(named, .false., control)
    call check_close(log, control%least_size(), 1.0e-8_rk, 1.0e-15_rk, 'the least size')
    num_cuts = 0
    gives_up = .false.
    do while (.not. gives_up)
      call control%cut(control%size, 1.0_rk, gives_up)
      num_cuts = num_cuts + 1
    end do
    call check(log, num_cuts == 20, '0.01 s over 2**19 is above 1e-8 s')
  end subroutine cut_to_the_smallest

  !> A size that was cut grows after four increments that converged slowly; after eight when the
  !> first one of the larger size was cut. A size that was never cut stays.
  subroutine slow_increments_grow(log, plan)
    type(test_log), intent(inout) :: log
    type(step), intent(in) :: plan
    type(increment_control) :: control
    logical :: gives_up
    integer :: i
    call start_control(plan, .false., control)
    do i = 1, 40
      call control%accept(30)
    end do
    call check_close(log, control%size, 0.1_rk, 1.0e-15_rk, 'no growth without a cut')
    call control%cut(0.1_rk, 1.0_rk, gives_up)
    call stay(log, control, 4, 0.05_rk, 'cut')
    call check_close(log, control%size, 0.075_rk, 1.0e-15_rk, 'grown')
    call control%cut(0.075_rk, 1.0_rk, gives_up)
    call stay(log, control, 8, 0.0375_rk, 'cut at once')
    call check_close(log, control%size, 0.05625_rk, 1.0e-15_rk, 'grown later')
    call control%accept(30)
    call control%cut(0.05625_rk, 1.0_rk, gives_up)
    do i = 1, 4
      call control%accept(30)
    end do
    call check(log, control%size > 0.03_rk, 'the larger size served once: four increments again')
  end subroutine slow_increments_grow

  !> Increments of one size that converge slowly.
  subroutine stay(log, control, num_increments, size_of_all, what)
    type(test_log), intent(inout) :: log
    type(increment_control), intent(inout) :: control
    integer, intent(in) :: num_increments
    real(rk), intent(in) :: size_of_all
    character(*), intent(in) :: what
    integer :: i
    do i = 1, num_increments
      call check_close(log, control%size, size_of_all, 1.0e-15_rk, what)
      call control%accept(30)
    end do
  end subroutine stay

  !> Sizes that follow an error: powers of two within the limits, doubled at their multiples.
  subroutine follow_an_error(log, given)
    type(test_log), intent(inout) :: log
    type(step), intent(in) :: given
    type(step) :: plan
    type(increment_control) :: control
    logical :: gives_up
    integer :: i
    plan = given
    plan%controls%accuracy = 0.02_rk
    plan%procedure%has_inertia = .true.
    plan%finest_increment = 0.0011_rk
    plan%largest_increment = 0.04_rk
    call start_control(plan, .true., control)
    call control%follow_error(0.01_rk, -2)
    call check_close(log, control%size, 0.0025_rk, 1.0e-15_rk, 'quartered')
    call control%follow_error(0.01_rk, -2)
    call check_close(log, control%size, 0.00125_rk, 1.0e-15_rk, 'the finest is above the limit')
    do i = 1, 10
      call control%accept(3)
    end do
    call control%follow_error(0.01125_rk, 1)
    call check_close(log, control%size, 0.00125_rk, 1.0e-15_rk, 'no multiple of the new size')
    call control%follow_error(0.0125_rk, 1)
    call check_close(log, control%size, 0.0025_rk, 1.0e-15_rk, 'doubled')
    call control%follow_error(0.015_rk, 1)
    call check_close(log, control%size, 0.0025_rk, 1.0e-15_rk, 'not again at once')
    call control%cut(0.01_rk, 0.2_rk, gives_up)
    call check_close(log, control%size, 0.00125_rk, 1.0e-15_rk, 'cut to a power of two')
  end subroutine follow_an_error
end program test_step_control
