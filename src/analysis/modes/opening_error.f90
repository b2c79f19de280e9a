!> Errors of the time integration and of the mesh in openings, as far as modes show them (theory.md,
!> 14.4-14.5). The modes with closed joints do not open them; how the opening follows the modes
!> while joints are open is found from the run itself, by least squares.
module opening_error
  use kinds, only: rk
  use joint_law, only: joint_state, state_open
  use joint_opening, only: opening_of
  use modal_errors, only: modal_error
  use small_matrix, only: solve_dense
  implicit none
  private
  public :: count_broken, note_opening, error_of_opening, mesh_error_of_opening, rocks

  !> Added to the diagonal of the sums, over its mean: modes that hardly move explain nothing.
  real(rk), parameter :: share = 1.0e-3_rk

  !> For what is left out: further modes, and the change of joint forces by the error itself.
  !> Measured on the problems of verification.md: 1.1 to 2.7.
  real(rk), parameter :: left_out = 1.5_rk
  !> The same for errors of the mesh, measured in an arch dam: 1.6 to 5.
  real(rk), parameter :: left_out_of_mesh = 3.0_rk
  !> Of the largest opening: a larger error of histories is a drift in time, and says nothing of how
  !> far joints open.
  real(rk), parameter :: largest_drift = 0.5_rk
  !> Of the forces of the modes, in squares: bending columns lose 0.1 to 0.81, rocking ones 0.94 and
  !> more (verification.md).
  real(rk), parameter :: most_lost = 0.9_rk
  !> Of the changes of the opening, in squares: most dams and bending columns have 0.25 to 0.99;
  !> slender blocks side by side that hit each other, 0.05 to 0.23, where the estimate was up to 250
  !> times too small.
  real(rk), parameter :: least_explained = 0.24_rk

contains

  !> Points of joints that have lost their strength, or never had any.
  pure integer function count_broken(joints) result(num_broken)
    type(joint_state), intent(in) :: joints(:)
    integer :: j
    num_broken = 0
    do j = 1, size(joints)
      num_broken = num_broken + count(joints(j)%is_broken)
    end do
  end function count_broken

  !> Includes an increment in which the largest opening was open from its start to its end.
  subroutine note_opening(joints, jump_rate, dt, moved, own)
    type(joint_state), intent(in) :: joints(:) !< at the end
    real(rk), intent(in) :: jump_rate(:, :) !< (3, points) in the increment [m/s]
    real(rk), intent(in) :: dt !< [s]
    real(rk), intent(in) :: moved(:) !< (modes) displacements of the increment
    type(modal_error), intent(inout) :: own
    real(rk) :: opening, change, follows(size(moved))
    integer :: n
    n = size(moved)
    own%num_lost = max(own%num_lost, count_broken(joints) - own%num_broken)
    if (.not. allocated(own%square)) then
      allocate (own%square(n, n), own%product(n), own%at_most(n), source=0.0_rk)
    end if
    call find_largest(joints, jump_rate, opening, change)
    change = dt*change
    own%opening = max(own%opening, opening)
    if (opening <= max(0.0_rk, change)) return
    own%square = own%square + opening*spread(moved, 2, n)*spread(moved, 1, n)
    own%product = own%product + opening*change*moved
    own%changes = own%changes + opening*change**2
    follows = trend(own)
    if (abs(dot_product(follows, own%error)) > abs(dot_product(follows, own%at_most))) then
      own%at_most = own%error
    end if
    if (.not. allocated(own%softer)) return
    if (abs(dot_product(follows, own%softer - own%exact)) &
        > abs(dot_product(follows, own%mesh_at_most))) own%mesh_at_most = own%softer - own%exact
  end subroutine note_opening

  !> The largest opening and its rate. Intact bonds do not open: their springs yield.
  pure subroutine find_largest(joints, jump_rate, opening, rate)
    type(joint_state), intent(in) :: joints(:)
    real(rk), intent(in) :: jump_rate(:, :) !< (3, points) in the increment [m/s]
    real(rk), intent(out) :: opening !< 0 where all are closed [m]
    real(rk), intent(out) :: rate !< [m/s]
    real(rk) :: own
    integer :: j, p, before
    opening = 0.0_rk
    rate = 0.0_rk
    before = 0
    do j = 1, size(joints)
      do p = 1, size(joints(j)%gap)
        own = opening_of(joints(j)%jump(1, p), joints(j)%gap(p))
        if (own <= opening .or. joints(j)%status(p) /= state_open) cycle
        opening = own
        rate = jump_rate(1, before + p)
      end do
      before = before + size(joints(j)%gap)
    end do
  end subroutine find_largest

  !> How the opening follows the modes [m] per unit of the modes.
  function trend(own) result(follows)
    type(modal_error), intent(in) :: own
    real(rk) :: follows(size(own%product))
    real(rk) :: a(size(follows), size(follows)), x(size(follows), 1), mean
    logical :: is_singular
    integer :: k
    a = own%square
    mean = sum([(a(k, k), k=1, size(follows))])/size(follows)
    do k = 1, size(follows)
      a(k, k) = a(k, k) + share*mean
    end do
    call solve_dense(a, reshape(own%product, [size(follows), 1]), x, is_singular)
    follows = x(:, 1)
    if (is_singular) follows = 0.0_rk
  end function trend

  !> Which share of the changes of the opening the modes explain, in squares.
  real(rk) function explained(own, follows) result(share_of_modes)
    type(modal_error), intent(in) :: own
    real(rk), intent(in) :: follows(:) !< (modes) the trend
    share_of_modes = (2.0_rk*dot_product(follows, own%product) &
                      - dot_product(follows, matmul(own%square, follows))) &
                     /max(tiny(1.0_rk), own%changes)
  end function explained

  !> Whether joints have lost so much of the forces of the modes that bodies rock, or bonds break.
  pure logical function leaves_modes(own)
    type(modal_error), intent(in) :: own
    leaves_modes = own%lost > most_lost*own%held .or. own%num_lost > 0
  end function leaves_modes

  !> Whether joints have lost so much of the forces of the modes that bodies rock, bonds break, or
  !> openings do not follow the modes: nor do their errors.
  logical function rocks(own)
    type(modal_error), intent(in) :: own
    rocks = leaves_modes(own)
    if (own%changes > 0.0_rk .and. .not. rocks) then
      rocks = explained(own, trend(own)) < least_explained
    end if
  end function rocks

  !> The largest opening so far [m], the largest error of openings [m], and their quotient; errors
  !> below 0 where bodies rock or bonds break.
  function error_of_opening(own) result(found)
    type(modal_error), intent(in) :: own
    real(rk), allocatable :: follows(:)
    real(rk) :: found(3), share_of_modes
    found = 0.0_rk
    if (.not. own%opening > 0.0_rk) return
    found = [own%opening, -1.0_rk, -1.0_rk]
    if (leaves_modes(own)) return
    follows = trend(own)
    share_of_modes = 1.0_rk
    if (own%changes > 0.0_rk) share_of_modes = explained(own, follows)
    if (share_of_modes < least_explained) return
    found(2) = left_out*abs(dot_product(follows, own%at_most))/sqrt(share_of_modes)
    found(3) = found(2)/own%opening
  end function error_of_opening

  !> The largest error of openings by the mesh [m]; -1 where it is not known.
  real(rk) function mesh_error_of_opening(own) result(error)
    type(modal_error), intent(in) :: own
    error = -1.0_rk
    if (own%opening > 0.0_rk .and. allocated(own%mesh_at_most)) then
      if (rocks(own)) return
      error = left_out_of_mesh*abs(dot_product(trend(own), own%mesh_at_most))
      if (error > largest_drift*own%opening) error = -1.0_rk
    end if
  end function mesh_error_of_opening
end module opening_error
