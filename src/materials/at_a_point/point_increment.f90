!> One increment of a material at one point, with prescribed strains in some components and
!> prescribed stresses in the others: Newton's method on the free strains.
module point_increment
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use kinds, only: rk
  use material_law, only: stress_law
  use material_points, only: point_set, point_state, time_increment, update_report, &
                             consistent_tangent, secant_tangent
  use small_matrix, only: outer_product, solve_dense
  implicit none
  private
  public :: point_control, increment_outcome, solve_increment

  !> Prescribed components at the end of the increment.
  type :: point_control
    logical :: is_stress(6) = .false. !< else a strain
    real(rk) :: value(6) = 0.0_rk !< strain, or stress [Pa]
    real(rk) :: share(6) = 0.0_rk !< stress = value + share*S11
    real(rk) :: tolerance = 1.0e-9_rk !< error of a stress over the largest stress
    real(rk) :: largest = 0.0_rk !< stress so far [Pa]
  end type point_control

  type :: increment_outcome
    logical :: has_converged = .false.
    integer :: iterations = 0 !< calls of the law
    real(rk) :: size_ratio = 0.5_rk !< of the next try, over the present increment
    character(:), allocatable :: message !< of the law, '' for none
  end type increment_outcome

  integer, parameter :: most_iterations = 40 !< with one kind of tangent
  integer, parameter :: most_halvings = 6 !< of a correction that increases the error
  real(rk), parameter :: least_gain = 1.0e-4_rk !< least decrease of the error, relative
  real(rk), parameter :: least_ratio = 0.1_rk !< least ratio of one cut

contains

  !> Finds the strains at the end of the increment with the consistent tangent. Without convergence
  !> Broyden's updates of the secant tangent are tried, which depend on stresses alone.
  subroutine solve_increment(law, points, time, control, old, new, tangent, outcome)
    class(stress_law), intent(in) :: law
    type(point_set), intent(in) :: points !< one point
    type(time_increment), intent(in) :: time
    type(point_control), intent(in) :: control
    type(point_state), intent(in) :: old !< converged
    type(point_state), intent(inout) :: new
    real(rk), intent(inout) :: tangent(6, 6, 1) !< on entry that of `old`
    type(increment_outcome), intent(out) :: outcome
    integer, parameter :: kinds(2) = [consistent_tangent, secant_tangent]
    type(time_increment) :: now
    real(rk) :: first_tangent(6, 6, 1)
    integer :: i, num_before
    first_tangent = tangent
    num_before = 0
    do i = 1, size(kinds)
      now = time
      now%tangent = kinds(i)
      if (i > 1) call law%elastic_stiffness(first_tangent(:, :, 1))
      tangent = first_tangent
      new = old
      where (.not. control%is_stress) new%strain(:, 1) = control%value
      call iterate_on_strain(law, points, now, control, old, new, tangent, outcome)
      if (i > 1) tangent = first_tangent
      outcome%iterations = outcome%iterations + num_before
      num_before = outcome%iterations
      if (outcome%has_converged .or. .not. any(control%is_stress)) exit
      if (outcome%size_ratio < 0.5_rk) exit ! the law requests a smaller increment
    end do
  end subroutine solve_increment

  !> Newton's method with a search along each correction.
  subroutine iterate_on_strain(law, points, time, control, old, new, tangent, outcome)
    class(stress_law), intent(in) :: law
    type(point_set), intent(in) :: points
    type(time_increment), intent(in) :: time
    type(point_control), intent(in) :: control
    type(point_state), intent(in) :: old
    type(point_state), intent(inout) :: new !< on entry with the prescribed strains
    real(rk), intent(inout) :: tangent(6, 6, 1)
    type(increment_outcome), intent(out) :: outcome
    real(rk) :: correction(6), strain(6), lack(6), matrix(6, 6), error, allowed, largest
    integer :: iteration, halving
    logical :: is_good
    outcome%message = ''
    strain = new%strain(:, 1)
    matrix = matrix_of(control, tangent(:, :, 1))
    lack = stress_error(control, old%stress(:, 1) + &
                        matmul(tangent(:, :, 1), strain - old%strain(:, 1)))
    correction = correction_of(control, lack, matrix)
    largest = huge(1.0_rk)
    do iteration = 1, most_iterations
      do halving = 0, most_halvings
        new%strain(:, 1) = strain + correction
        call try_strain(law, points, time, old, new, tangent, outcome, is_good)
        error = huge(1.0_rk)
        if (is_good) error = maxval(abs(stress_error(control, new%stress(:, 1))))
        allowed = control%tolerance*max(control%largest, maxval(abs(new%stress)))
        outcome%has_converged = is_good .and. error <= allowed
        if (outcome%has_converged) return
        if (is_good .and. error <= (1.0_rk - least_gain)*largest) exit
        if (.not. any(control%is_stress)) return
        correction = 0.5_rk*correction
      end do
      if (.not. is_good) return
      if (time%tangent == consistent_tangent) then
        matrix = matrix_of(control, tangent(:, :, 1))
      else if (iteration > 1) then
        call update_matrix(correction, stress_error(control, new%stress(:, 1)) - lack, matrix)
      end if
      largest = error
      strain = new%strain(:, 1)
      lack = stress_error(control, new%stress(:, 1))
      correction = correction_of(control, lack, matrix)
    end do
  end subroutine iterate_on_strain

  !> Calls the law and checks its results.
  subroutine try_strain(law, points, time, old, new, tangent, outcome, is_good)
    class(stress_law), intent(in) :: law
    type(point_set), intent(in) :: points
    type(time_increment), intent(in) :: time
    type(point_state), intent(in) :: old
    type(point_state), intent(inout) :: new
    real(rk), intent(inout) :: tangent(6, 6, 1)
    type(increment_outcome), intent(inout) :: outcome
    logical, intent(out) :: is_good !< stresses and tangent can be used
    type(update_report) :: report
    if (law%wants_gradient) new%gradient(:, :, 1) = gradient_of(new%strain(:, 1))
    outcome%iterations = outcome%iterations + 1
    call law%update(points, time, old, new, tangent, report)
    is_good = report%failed_point == 0 .and. .not. report%size_ratio < 1.0_rk
    if (.not. is_good .and. allocated(report%message)) outcome%message = report%message
    if (report%size_ratio < 1.0_rk) then
      outcome%size_ratio = max(least_ratio, min(outcome%size_ratio, report%size_ratio))
    end if
    if (.not. is_good) return
    is_good = all(ieee_is_finite(new%stress)) .and. all(ieee_is_finite(tangent))
    if (.not. is_good) outcome%message = 'the law returns NaN or infinity'
  end subroutine try_strain

  !> Errors of the prescribed stresses, zero for the other components [Pa].
  pure function stress_error(control, stress) result(error)
    type(point_control), intent(in) :: control
    real(rk), intent(in) :: stress(6)
    real(rk) :: error(6)
    error = 0.0_rk
    where (control%is_stress) error = stress - control%share*stress(1) - control%value
  end function stress_error

  !> Derivative of the errors of the prescribed stresses by the free strains; rows and columns of
  !> the unit matrix for the other components.
  pure function matrix_of(control, tangent) result(matrix)
    type(point_control), intent(in) :: control
    real(rk), intent(in) :: tangent(6, 6) !< [Pa]
    real(rk) :: matrix(6, 6)
    integer :: i
    do i = 1, 6
      matrix(i, :) = merge(tangent(i, :) - control%share(i)*tangent(1, :), 0.0_rk, &
                           control%is_stress .and. control%is_stress(i))
      if (.not. control%is_stress(i)) matrix(i, i) = 1.0_rk
    end do
  end function matrix_of

  !> Broyden's update: the smallest change of the matrix that reproduces the last step.
  pure subroutine update_matrix(change, gain, matrix)
    real(rk), intent(in) :: change(6) !< of the free strains, zero for the others
    real(rk), intent(in) :: gain(6) !< of the errors that came with it [Pa]
    real(rk), intent(inout) :: matrix(6, 6)
    real(rk) :: size_squared
    size_squared = sum(change**2)
    if (.not. size_squared > 0.0_rk) return
    matrix = matrix + outer_product((gain - matmul(matrix, change))/size_squared, change)
  end subroutine update_matrix

  !> Change of the free strains that removes the error of the stresses; zero for a singular matrix.
  pure function correction_of(control, error, matrix) result(correction)
    type(point_control), intent(in) :: control
    real(rk), intent(in) :: error(6), matrix(6, 6)
    real(rk) :: correction(6)
    real(rk) :: change(6, 1)
    logical :: is_singular
    correction = 0.0_rk
    if (.not. any(control%is_stress)) return
    call solve_dense(matrix, reshape(-error, [6, 1]), change, is_singular)
    if (is_singular) return
    if (all(ieee_is_finite(change))) correction = merge(change(:, 1), 0.0_rk, control%is_stress)
  end function correction_of

  !> The displacement gradient of a strain without rotation.
  pure function gradient_of(strain) result(gradient)
    real(rk), intent(in) :: strain(6) !< shear as gamma
    real(rk) :: gradient(3, 3), half(3)
    half = 0.5_rk*strain(4:6)
    gradient = reshape([strain(1), half(1), half(2), half(1), strain(2), half(3), half(2), &
                        half(3), strain(3)], [3, 3])
  end function gradient_of
end module point_increment
