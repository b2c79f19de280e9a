!> The constants of a step of the method of Hilber, Hughes & Taylor (theory.md, (7.1)-(7.2)).
!>
!> With the predictors u^ = u0 + dt v0 + dt^2 (1/2 - beta) a0 and v^ = v0 + dt (1 - gamma) a0:
!> a1 = (u1 - u^)/(beta dt^2) and v1 = v^ + gamma dt a1.
module hht_scheme
  use kinds, only: rk
  implicit none
  private
  public :: hht, make_scheme

  !> What the scheme makes of one increment size.
  type :: hht
    real(rk) :: alpha = 0.0_rk, beta = 0.25_rk, gamma = 0.5_rk
    real(rk) :: dt = 0.0_rk !< [s]
    real(rk) :: acceleration_of_x = 0.0_rk !< 1/(beta dt^2) [1/s2]
    real(rk) :: velocity_of_x = 0.0_rk !< gamma/(beta dt) [1/s]
    real(rk) :: joint_weight = 1.0_rk !< of the joint forces at the end of the step
    real(rk) :: old_joint_weight = 0.0_rk !< of the joint forces at the start
    logical :: carries_impulse = .false. !< joint forces by the implicit impulse (7.3)
  contains
    procedure :: is_for
  end type hht

  !> Sizes of increments that differ by less, over the size, are the same: differences of times have
  !> a round-off of 1e-16 of the time.
  real(rk), parameter :: same_size = 1.0e-12_rk

contains

  !> Whether the scheme is that of an increment size.
  pure logical function is_for(self, dt)
    class(hht), intent(in) :: self
    real(rk), intent(in) :: dt !< [s]
    is_for = abs(dt - self%dt) <= same_size*dt
  end function is_for

  !> The scheme for one increment size. Joint forces are 'IMPLICIT' (impulse dt times the force at
  !> the end), 'HHT' (weighted as the bulk) or 'END' (force at the end).
  pure function make_scheme(alpha, dt, joint_forces) result(scheme)
    real(rk), intent(in) :: alpha !< -1/3..0
    real(rk), intent(in) :: dt !< [s]
    character(*), intent(in) :: joint_forces
    type(hht) :: scheme
    scheme%alpha = alpha
    scheme%beta = 0.25_rk*(1.0_rk - alpha)**2
    scheme%gamma = 0.5_rk - alpha
    scheme%dt = dt
    scheme%acceleration_of_x = 1.0_rk/(scheme%beta*dt**2)
    scheme%velocity_of_x = scheme%gamma/(scheme%beta*dt)
    select case (joint_forces)
    case ('HHT')
      scheme%joint_weight = 1.0_rk + alpha
      scheme%old_joint_weight = -alpha
    case ('END')
      scheme%joint_weight = 1.0_rk
      scheme%old_joint_weight = 0.0_rk
    case default
      scheme%carries_impulse = .true.
      scheme%joint_weight = 1.0_rk/scheme%gamma
      scheme%old_joint_weight = -(1.0_rk - scheme%gamma)/scheme%gamma
    end select
  end function make_scheme
end module hht_scheme
