!> Water in joints while a step goes on: how far it gets into those that are open, and what pressure
!> the points have.
!>
!> Where the profile is OPEN the forces are constant within an increment. In a static step the
!> increment is solved again until the joints that it leaves open are those that were wet; in a
!> dynamic step the water is where the joint was open at the end of the increment before.
module joint_water
  use kinds, only: rk
  use joint_law, only: joint_state, state_open
  use joint_operator, only: jump_operator
  use load_uplift, only: uplift_load, water_where_open
  use problem_definition, only: problem
  use step_loads, only: load_group, step_time, factor_at
  use step_plan, only: step_load
  use run_ledger, only: ledger
  implicit none
  private
  public :: update_uplift, record_uplift

contains

  !> Lets the water into what is open in `states`; tells whether that has changed the forces.
  subroutine update_uplift(scene, operator, states, groups, has_changed)
    type(problem), intent(in) :: scene
    type(jump_operator), intent(in) :: operator
    type(joint_state), intent(in) :: states(:)
    type(load_group), intent(inout) :: groups(:)
    logical, intent(out) :: has_changed
    real(rk), allocatable :: pressure(:)
    integer :: g
    has_changed = .false.
    do g = 1, size(groups)
      if (groups(g)%uplift == 0) cycle
      select type (water => scene%loads(groups(g)%uplift)%item)
      type is (uplift_load)
        associate (now => states(water%seam))
          allocate (pressure(size(now%status)))
          call water_where_open(water, now%status == state_open, pressure)
          if (.not. allocated(groups(g)%pressure)) groups(g)%pressure = 0.0_rk*pressure
          if (any(abs(pressure - groups(g)%pressure) > 0.0_rk)) then
            has_changed = .true.
            groups(g)%force = 0.0_rk
            call push_faces(operator, water%seam, pressure, groups(g)%force)
          end if
        end associate
        call move_alloc(pressure, groups(g)%pressure)
      end select
    end do
  end subroutine update_uplift

  !> Forces B^T (area p) on the opening of the points of one joint.
  subroutine push_faces(operator, seam, pressure, force)
    type(jump_operator), intent(in) :: operator
    integer, intent(in) :: seam !< joint
    real(rk), intent(in) :: pressure(:) !< (points of the joint) [Pa]
    real(rk), intent(inout) :: force(:) !< (num_total) [N]
    real(rk) :: traction(3, operator%num_points)
    traction = 0.0_rk
    traction(1, operator%first_point(seam):operator%first_point(seam + 1) - 1) = pressure
    call operator%add_forces(traction, force)
  end subroutine push_faces

  !> The pressure of the water at the points of the joints that have any, for the results.
  subroutine record_uplift(scene, loads, groups, when, states, costs)
    type(problem), intent(in) :: scene
    type(step_load), intent(in) :: loads(:) !< of the step
    type(load_group), intent(in) :: groups(:)
    type(step_time), intent(in) :: when
    type(joint_state), intent(inout) :: states(:)
    type(ledger), intent(inout) :: costs
    real(rk) :: factor
    integer :: i, j, g
    do j = 1, size(states)
      if (allocated(states(j)%water)) deallocate (states(j)%water)
    end do
    do i = 1, size(loads)
      select type (water => scene%loads(loads(i)%load)%item)
      type is (uplift_load)
        call costs%start('recover', water%name, water%kind)
        factor = factor_at(loads(i)%start_factor, loads(i)%end_factor, loads(i)%amplitude, &
                           scene%amplitudes, when)
        associate (now => states(water%seam))
          if (.not. allocated(now%water)) now%water = 0.0_rk*water%pressure
          g = findloc(groups%uplift, loads(i)%load, dim=1)
          if (g == 0) then
            now%water = now%water + factor*water%pressure
          else
            now%water = now%water + factor*groups(g)%pressure
          end if
        end associate
        call costs%stop()
      end select
    end do
  end subroutine record_uplift
end module joint_water
