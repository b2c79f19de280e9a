!> Random strain paths of one point of concrete, and the faults that must not occur on them.
!>
!> A path starts from a virgin point or from one that is cracked, crushed or both to the end of its
!> curves (damage 0.99). It has five increments, each of a random size between 1e-6 and 1e-2, of
!> random principal strains (all patterns of signs; one in four with two equal values, one in
!> eight with three), along random axes or, one in four, along those of the last increment. One in
!> six goes back to where the path began.
!>
!> Dissipation is measured twice: the growth of the energies that the law reports, and the work of
!> the nominal stress at the end of the increment on the plastic strain of the increment, which
!> takes nothing from the law but the state it leaves.
module concrete_paths
  use damage_curves, only: curve_value, value_of_curve
  use damage_model, only: concrete_model, place_curves, placed_curves
  use damage_split, only: tension_at
  use damage_point, only: update_point
  use damage_states, only: point_answer, point_history, point_motion
  use damage_yield, only: yield_at, yield_value
  use kinds, only: rk
  use tensor6, only: principal_values, second_invariant, trace
  implicit none
  private
  public :: path_counts, run_paths

  integer, parameter :: increments_of_path = 5
  real(rk), parameter :: width = 0.4_rk !< of the element [m]
  !> Work that roundoff makes, over the product of stress and increment of strain.
  real(rk), parameter :: roundoff = 1.0e-10_rk

  !> Results of the paths.
  type :: path_counts
    integer :: paths = 0, updates = 0, yielding = 0
    integer :: failures = 0 !< without convergence of the law
    integer :: not_numbers = 0 !< NaN or infinity in stress, history, energy or tangent
    integer :: off_surface = 0 !< F above 1e-8 of the strength at the end
    integer :: energy_gains = 0 !< a reported dissipation below zero
    integer :: work_gains = 0 !< the plastic strain gives work back
    integer :: bad_histories = 0 !< a measure that falls, a damage that falls or reaches 1
    real(rk) :: worst_residual = 0.0_rk !< |F| over the strength in compression, where it yields
    real(rk) :: worst_gain = 0.0_rk !< over stress times increment of strain
  end type path_counts

contains

  !> Paths of one concrete.
  subroutine run_paths(model, num_paths, counts)
    type(concrete_model), intent(in) :: model
    integer, intent(in) :: num_paths
    type(path_counts), intent(inout) :: counts
    type(point_history) :: history, new
    type(point_motion) :: motion
    type(point_answer) :: answer
    type(placed_curves) :: placed
    real(rk) :: axes(3, 3), chance
    integer :: path, increment, i
    do path = 1, num_paths
      counts%paths = counts%paths + 1
      motion = point_motion(time=0.1_rk)
      do i = 1, 3
        motion%edges(i, i) = width
      end do
      call start_history(model, mod(path, 4), placed, history)
      call draw_axes(axes)
      do increment = 1, increments_of_path
        motion%before = motion%strain
        call random_number(chance)
        if (chance > 0.25_rk) call draw_axes(axes)
        motion%strain = motion%strain + drawn_strain(axes)
        if (chance > 5.0_rk/6.0_rk) motion%strain = 0.0_rk
        call update_point(model, motion, history, placed, new, answer)
        call judge(model, motion, history, new, answer, placed, counts)
        history = new
      end do
    end do
  end subroutine run_paths

  !> Virgin, cracked, crushed or both.
  subroutine start_history(model, kind, placed, history)
    type(concrete_model), intent(in) :: model
    integer, intent(in) :: kind !< 0..3
    type(placed_curves), intent(inout) :: placed
    type(point_history), intent(out) :: history
    call place_curves(model, width, placed)
    if (btest(kind, 0)) then
      history%backbone%measures(1) = placed%tension(size(placed%tension))
      history%backbone%width = width
      history%damage(1) = model%tension%damage(size(placed%tension))
    end if
    if (btest(kind, 1)) then
      history%backbone%measures(2) = placed%compression(size(placed%compression))
      history%damage(2) = model%compression%damage(size(placed%compression))
    end if
  end subroutine start_history

  !> Three orthonormal directions.
  subroutine draw_axes(axes)
    real(rk), intent(out) :: axes(3, 3)
    real(rk) :: q(4)
    call random_number(q)
    q = q - 0.5_rk
    q = q/norm2(q)
    axes(:, 1) = [1.0_rk - 2.0_rk*(q(3)**2 + q(4)**2), 2.0_rk*(q(2)*q(3) + q(4)*q(1)), &
                  2.0_rk*(q(2)*q(4) - q(3)*q(1))]
    axes(:, 2) = [2.0_rk*(q(2)*q(3) - q(4)*q(1)), 1.0_rk - 2.0_rk*(q(2)**2 + q(4)**2), &
                  2.0_rk*(q(3)*q(4) + q(2)*q(1))]
    axes(:, 3) = [2.0_rk*(q(2)*q(4) + q(3)*q(1)), 2.0_rk*(q(3)*q(4) - q(2)*q(1)), &
                  1.0_rk - 2.0_rk*(q(2)**2 + q(3)**2)]
  end subroutine draw_axes

  !> An increment of strain along axes, engineering shear.
  function drawn_strain(axes) result(strain)
    real(rk), intent(in) :: axes(3, 3)
    real(rk) :: strain(6)
    real(rk) :: chance(5), values(3), matrix(3, 3)
    integer :: i
    call random_number(chance)
    values = (2.0_rk*chance(1:3) - 1.0_rk)*10.0_rk**(-2.0_rk - 4.0_rk*chance(4))
    if (chance(5) < 0.25_rk) values(2) = values(1)
    if (chance(5) < 0.125_rk) values(3) = values(1)
    matrix = 0.0_rk
    do i = 1, 3
      matrix = matrix + values(i)*spread(axes(:, i), 2, 3)*spread(axes(:, i), 1, 3)
    end do
    strain = [matrix(1, 1), matrix(2, 2), matrix(3, 3), 2.0_rk*matrix(1, 2), 2.0_rk*matrix(1, 3), &
              2.0_rk*matrix(2, 3)]
  end function drawn_strain

  !> Counts what is wrong with one update.
  subroutine judge(model, motion, old, new, answer, placed, counts)
    type(concrete_model), intent(in) :: model
    type(point_motion), intent(in) :: motion
    type(point_history), intent(in) :: old, new
    type(point_answer), intent(in) :: answer
    type(placed_curves), intent(in) :: placed
    type(path_counts), intent(inout) :: counts
    real(rk) :: flow(6), work, size_of_work
    counts%updates = counts%updates + 1
    if (.not. answer%has_converged) counts%failures = counts%failures + 1
    if (.not. all(abs([answer%stress, reshape(answer%tangent, [36]), answer%stored, &
                       answer%fracture, answer%crushing, new%plastic_strain, new%damage, &
                       new%backbone%measures, new%backbone%strain]) < huge(1.0_rk))) then
      counts%not_numbers = counts%not_numbers + 1
      return
    end if
    if (any(new%backbone%measures < old%backbone%measures) .or. any(new%damage >= 1.0_rk) .or. &
        any(new%damage < old%damage*(1.0_rk - roundoff))) then
      counts%bad_histories = counts%bad_histories + 1
    end if
    flow = new%plastic_strain - old%plastic_strain
    size_of_work = norm2(answer%stress)*norm2(motion%strain - motion%before) + tiny(work)
    work = dot_product(answer%stress, flow)/size_of_work
    if (work < -roundoff) counts%work_gains = counts%work_gains + 1
    counts%worst_gain = max(counts%worst_gain, -work)
    if (min(answer%fracture, answer%crushing) < -roundoff*size_of_work) then
      counts%energy_gains = counts%energy_gains + 1
    end if
    call judge_surface(model, motion%strain, old, new, placed, counts)
  end subroutine judge

  !> F at the end, from the state alone.
  subroutine judge_surface(model, strain, old, new, placed, counts)
    type(concrete_model), intent(in) :: model
    real(rk), intent(in) :: strain(6)
    type(point_history), intent(in) :: old, new
    type(placed_curves), intent(in) :: placed
    type(path_counts), intent(inout) :: counts
    type(curve_value) :: tension, compression
    type(yield_value) :: f
    real(rk) :: stress(6), principal(3), residual
    integer :: rows(2)
    stress(4:6) = model%shear*(strain(4:6) - new%backbone%strain(4:6))
    stress(1:3) = 2.0_rk*model%shear*(strain(1:3) - new%backbone%strain(1:3)) &
                  + (model%bulk - 2.0_rk/3.0_rk*model%shear) &
                  *sum(strain(1:3) - new%backbone%strain(1:3))
    rows = 1
    call tension_at(model, placed, new%backbone%measures(1), rows(1), tension)
    call value_of_curve(model%compression, placed%compression, 1.0_rk, new%backbone%measures(2), &
                        rows(2), compression)
    principal = principal_values(stress)
    f = yield_at(model, sqrt(3.0_rk*second_invariant(stress)), -trace(stress)/3.0_rk, &
                 principal(1), tension%strength, compression%strength)
    residual = f%value/compression%strength
    if (any(abs(new%backbone%strain - old%backbone%strain) > 0.0_rk)) then
      counts%yielding = counts%yielding + 1
      residual = abs(residual)
      counts%worst_residual = max(counts%worst_residual, residual)
    end if
    if (residual > 1.0e-8_rk) counts%off_surface = counts%off_surface + 1
  end subroutine judge_surface
end module concrete_paths
