!> The error in time of a step whose increments follow it (theory.md, 7.5).
!>
!> The error of an increment is c dt^3 u''', with u''' from the third difference of the
!> displacements and c of the period that the method gives. Motion that the increments do not
!> resolve counts with its displacement, not with its large accelerations. Errors add up and decay
!> with the damping of the motion.
module error_in_time
  use kinds, only: rk
  use analysis_state, only: motion, state, time_accuracy
  use global_vectors, only: diagonal, dot
  use step_plan, only: step
  use step_system, only: dam_system
  use unknown_parts, only: unknown_part
  implicit none
  private
  public :: motion_norm, make_norm, note_error_in_time

  !> The norm of displacements that masses weight.
  type :: motion_norm
    real(rk), allocatable :: mass(:) !< (num_total) at each unknown [kg]
    type(unknown_part) :: part !< unknowns of this rank
  contains
    procedure :: of => norm_of
  end type motion_norm

  !> A rate that oscillates is the largest one times |sin|.
  real(rk), parameter :: top_of_mean = 0.5_rk*acos(-1.0_rk)
  !> First increments of the mean and of the slow fall of its maximum.
  real(rk), parameter :: averaged = 10.0_rk, remembered = 100.0_rk
  !> A doubled increment has four times the error; it may use this share of the admissible one.
  real(rk), parameter :: growth_of_error = 4.0_rk, share_of_growth = 0.7_rk
  integer, parameter :: fewest_known = 3 !< increments of a third difference

contains

  !> The mass at each unknown: the mean over the unknowns of its node, so that the axes of the deck
  !> make no difference to mass along one direction. Unknowns without mass have no error in time of
  !> their own.
  subroutine make_norm(system, norm)
    type(dam_system), intent(in) :: system
    type(motion_norm), intent(out) :: norm
    real(rk) :: weights(system%matrix%num_total)
    real(rk) :: mass(system%numbers%num_nodes)
    integer :: unknowns(system%numbers%num_nodes)
    integer :: i
    call diagonal(system%mass_pattern, system%mass_entries, weights)
    mass = 0.0_rk
    unknowns = 0
    associate (node => system%numbers%node)
      do i = 1, size(weights)
        mass(node(i)) = mass(node(i)) + weights(i)
        unknowns(node(i)) = unknowns(node(i)) + 1
      end do
      norm%mass = mass(node)/unknowns(node)
    end associate
    norm%part = system%matrix%part
  end subroutine make_norm

  !> Takes in an increment that has converged, and tells how often the next one is to be doubled or,
  !> below zero, halved.
  subroutine note_error_in_time(plan, norm, size, before, after, doublings)
    type(step), intent(in) :: plan
    type(motion_norm), intent(in) :: norm
    real(rk), intent(in) :: size !< of the increment [s]
    type(state), intent(in) :: before
    type(state), intent(inout) :: after
    integer, intent(out) :: doublings
    real(rk) :: third, rate, damping
    after%accuracy = before%accuracy
    associate (own => after%accuracy)
      if (own%size > 0.0_rk) then ! rates of another size
        own%mean_rate = own%mean_rate*(size/own%size)**2
        own%held_rate = own%held_rate*(size/own%size)**2
      end if
      if (own%num_known == 0) then
        own%damped = before%energy%damping
        own%largest = norm%of(before%motion%q)
      end if
      own%largest = max(own%largest, norm%of(after%motion%q))
      call take_differences(norm, size, before%motion, after%motion, own, third)
      call average_motion(plan, norm, size, after%motion, third, own)
      own%kinetic = own%kinetic &
                    + 0.5_rk*size*(before%energy%kinetic + after%energy%kinetic)
      damping = damping_rate(own, after%energy%damping)*excess_of_frequency(own)
      rate = error_constant(plan)*third*size**2
      call add_error(plan, size, rate, damping, own)
      doublings = choose_change(plan, damping, own)
    end associate
  end subroutine note_error_in_time

  !> The third derivative of the displacements, from divided differences.
  subroutine take_differences(norm, size, old, new, own, third)
    type(motion_norm), intent(in) :: norm
    real(rk), intent(in) :: size
    type(motion), intent(in) :: old
    type(motion), intent(inout) :: new
    type(time_accuracy), intent(inout) :: own
    real(rk), intent(out) :: third !< its norm
    third = 0.0_rk
    new%slope = (new%q - old%q)/size
    if (own%num_known == 0) then
      new%bend = 0.0_rk*new%slope
    else
      new%bend = (new%slope - old%slope)/(size + own%size)
      if (own%num_known >= fewest_known - 1) then
        third = 6.0_rk*norm%of(new%bend - old%bend)/(size + own%size + own%size_before)
      end if
    end if
    own%size_before = own%size
    own%size = size
    own%num_known = min(own%num_known + 1, fewest_known)
  end subroutine take_differences

  !> Means of the squares of velocity, acceleration and third derivative.
  subroutine average_motion(plan, norm, size, moving, third, own)
    type(step), intent(in) :: plan
    type(motion_norm), intent(in) :: norm
    real(rk), intent(in) :: size
    type(motion), intent(in) :: moving
    real(rk), intent(in) :: third !< norm
    type(time_accuracy), intent(inout) :: own
    real(rk) :: share
    if (own%num_known < fewest_known) return
    share = 1.0_rk - exp(-size/(remembered*plan%first_increment))
    own%velocity_square = (1.0_rk - share)*own%velocity_square &
                          + share*norm%of(moving%slope)**2
    own%acceleration_square = (1.0_rk - share)*own%acceleration_square &
                              + share*4.0_rk*norm%of(moving%bend)**2
    own%third_square = (1.0_rk - share)*own%third_square + share*third**2
  end subroutine average_motion

  !> The frequency of the third derivative over that of the acceleration, 1 in a motion of one
  !> frequency: errors of quicker parts of the motion decay sooner.
  pure real(rk) function excess_of_frequency(own) result(ratio)
    type(time_accuracy), intent(in) :: own
    ratio = 1.0_rk
    if (own%acceleration_square > 0.0_rk) then
      ratio = max(1.0_rk, sqrt(own%velocity_square*own%third_square)/own%acceleration_square)
    end if
  end function excess_of_frequency

  !> Norm of displacements.
  real(rk) function norm_of(self, q)
    class(motion_norm), intent(in) :: self
    real(rk), intent(in) :: q(:) !< (num_total) [m]
    norm_of = sqrt(max(0.0_rk, dot(self%part, self%mass*q, q)))
  end function norm_of

  !> The part of the period by which a method misses it, over (omega dt)^2: of HHT, and of the
  !> trapezoidal rule for methods that are more accurate.
  pure real(rk) function error_constant(plan) result(c)
    type(step), intent(in) :: plan
    c = 1.0_rk/12.0_rk
    if (plan%procedure%uses_alpha) c = c - 0.25_rk*plan%alpha - 0.375_rk*plan%alpha**2
  end function error_constant

  !> Decay of free vibrations, zeta omega, as the damping has taken energy so far.
  pure real(rk) function damping_rate(own, damped) result(rate)
    type(time_accuracy), intent(in) :: own
    real(rk), intent(in) :: damped !< energy [J]
    rate = 0.0_rk
    if (own%kinetic > 0.0_rk) rate = max(0.0_rk, damped - own%damped)/(4.0_rk*own%kinetic)
  end function damping_rate

  !> Adds the error of an increment to the error so far.
  pure subroutine add_error(plan, size, rate, damping, own)
    type(step), intent(in) :: plan
    real(rk), intent(in) :: size, rate, damping
    type(time_accuracy), intent(inout) :: own
    real(rk) :: share
    own%error = own%error*exp(-damping*size) + rate*size
    own%largest_error = max(own%largest_error, own%error)
    share = 1.0_rk - exp(-size/(averaged*plan%first_increment))
    own%mean_rate = own%mean_rate + share*(rate - own%mean_rate)
    own%held_rate = max(own%mean_rate, &
                        own%held_rate*exp(-size/(remembered*plan%first_increment)))
  end subroutine add_error

  !> The change of the size: the rate of the error that adds up to the admissible error over the
  !> memory of the motion, or over the step.
  pure integer function choose_change(plan, damping, own) result(doublings)
    type(step), intent(in) :: plan
    real(rk), intent(in) :: damping
    type(time_accuracy), intent(in) :: own
    real(rk) :: admissible, memory
    doublings = 0
    if (own%num_known < fewest_known) return
    memory = plan%duration
    if (damping*memory > 1.0e-6_rk) memory = (1.0_rk - exp(-damping*memory))/damping
    admissible = plan%controls%accuracy*own%largest/memory
    if (top_of_mean*own%mean_rate > growth_of_error*admissible) then
      doublings = -2
    else if (top_of_mean*own%mean_rate > admissible) then
      doublings = -1
    else if (growth_of_error*top_of_mean*own%held_rate < share_of_growth*admissible) then
      doublings = 1
    end if
  end function choose_change
end module error_in_time
