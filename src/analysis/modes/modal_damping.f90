!> Modal damping: the modes of the undamaged model with closed joints have the ratio zeta each
!> (theory.md, (5.3)):
!>
!>   C = sum 2 zeta w_i c_i c_i^T,   c_i = M phi_i on the free unknowns, K phi_i/w_i^2 on supports
!>
!> The supports of the step hold the modes. c_i^T v is the rate of mode i in the motion relative to
!> that which follows the supports without inertia.
module modal_damping
  use eigen_modes, only: num_massive, solve_modes
  use equilibrium_linear, only: linear_equilibrium
  use errors, only: error_type, raise
  use global_vectors, only: multiply
  use kinds, only: rk
  use problem_definition, only: problem
  use run_ledger, only: ledger
  use step_equilibrium, only: factorise_closed
  use step_plan, only: step, step_damping
  use step_system, only: dam_system
  use write_text, only: as_text
  implicit none
  private
  public :: build_modal_damping, remark_on_modes

  real(rk), parameter :: two_pi = 2.0_rk*acos(-1.0_rk)
  !> Squares of frequencies that differ by less, over them, are those of modes that are not unique.
  real(rk), parameter :: same_frequency = 1.0e-6_rk
  integer, parameter :: first_guess = 10 !< modes to begin with where a highest frequency is given

contains

  !> Finds the modes and the columns sqrt(2 zeta w_i) c_i of the system.
  subroutine build_modal_damping(model, plan, system, costs, error)
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    type(dam_system), intent(inout) :: system
    type(ledger), intent(in) :: costs
    type(error_type), allocatable, intent(out) :: error
    type(linear_equilibrium) :: balance
    real(rk), allocatable :: closed(:), lambda(:), phi(:, :)
    if (.not. plan%damping%modal_ratio > 0.0_rk) return
    call factorise_closed(model, system, costs, closed, balance, error)
    if (allocated(error)) return
    call costs%start('solve', 'modes', 'solver')
    call choose_modes(plan%damping, system, closed, balance, lambda, phi, error)
    call costs%stop()
    if (allocated(error)) return
    call set_columns(plan%damping%modal_ratio, closed, lambda, phi, system)
  end subroutine build_modal_damping

  !> The columns of the modes.
  subroutine set_columns(ratio, closed, lambda, phi, system)
    real(rk), intent(in) :: ratio !< of the damping
    real(rk), intent(in) :: closed(:) !< values of K with closed joints
    real(rk), intent(in) :: lambda(:) !< (modes) w_i squared [1/s2]
    real(rk), intent(in) :: phi(:, :) !< (free unknowns, modes)
    type(dam_system), intent(inout) :: system
    real(rk), dimension(system%matrix%num_total) :: mode, inertia, elastic
    integer :: k
    deallocate (system%modal)
    allocate (system%modal(system%matrix%num_total, size(lambda)))
    mode = 0.0_rk
    associate (n => system%matrix%num_free)
      do k = 1, size(lambda)
        mode(:n) = phi(:, k)
        call multiply(system%matrix, system%mass, mode, inertia)
        call multiply(system%matrix, closed, mode, elastic)
        system%modal(:, k) = sqrt(2.0_rk*ratio*sqrt(lambda(k))) &
                             *[inertia(:n), elastic(n + 1:)/lambda(k)]
      end do
    end associate
  end subroutine set_columns

  !> As many modes as requested, with all modes of the frequency of the last one, or all modes up to
  !> the highest frequency.
  subroutine choose_modes(damping, system, closed, balance, lambda, phi, error)
    type(step_damping), intent(in) :: damping
    type(dam_system), intent(in) :: system
    real(rk), intent(in) :: closed(:) !< values of K with closed joints
    type(linear_equilibrium), intent(inout) :: balance !< holds its factor
    real(rk), allocatable, intent(out) :: lambda(:), phi(:, :)
    type(error_type), allocatable, intent(out) :: error
    real(rk) :: highest
    integer :: num_modes, most, num_below
    most = num_massive(system%matrix, system%mass)
    num_modes = min(first_guess, most)
    if (damping%num_modes > 0) num_modes = max(min(damping%num_modes + 1, most), damping%num_modes)
    do
      call solve_modes(system%matrix, closed, system%mass, balance%factor, num_modes, lambda, phi, &
                       error)
      if (allocated(error)) return
      highest = (two_pi*damping%highest)**2
      if (damping%num_modes > 0) highest = (1.0_rk + same_frequency)*lambda(damping%num_modes)
      num_below = count(lambda <= highest)
      if (num_below < num_modes .or. num_modes == most) exit
      num_modes = min(2*num_modes, most)
    end do
    if (num_below == 0) then
      call raise(error, '*DAMPING, MODAL: no mode up to HIGHEST='//as_text(damping%highest)// &
                 ' Hz; the lowest has '//as_text(sqrt(lambda(1))/two_pi)//' Hz')
      return
    end if
    lambda = lambda(:num_below)
    phi = phi(:, :num_below)
  end subroutine choose_modes

  !> What the log says where more modes are damped than the deck names; '' else.
  function remark_on_modes(plan, system) result(remark)
    type(step), intent(in) :: plan
    type(dam_system), intent(in) :: system
    character(:), allocatable :: remark
    remark = ''
    if (plan%damping%num_modes == 0 .or. size(system%modal, 2) <= plan%damping%num_modes) return
    remark = '*DAMPING, MODAL: '//as_text(size(system%modal, 2))//' modes are damped in place '// &
             'of '//as_text(plan%damping%num_modes)//': the last ones have one frequency'
  end function remark_on_modes
end module modal_damping
