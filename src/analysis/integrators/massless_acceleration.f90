!> Initial acceleration where M is singular: massless rock, a joint whose slave is the dam on such
!> rock, added mass on massless nodes (theory.md, 7.1).
!>
!> What has no mass is in static balance at all times: N^T (f - f_int) = 0, N a basis of the motions
!> without mass. The second derivative of this balance gives N^T K a = 0. With P = M + eps K, the
!> matrix P^-1 M P^-1 gives vectors that satisfy N^T K a = 0 and ignores the part of r on N, which
!> a static displacement of the massless part takes. Conjugate gradients for M a = r with this
!> preconditioner therefore find the acceleration of the constrained form without N.
!>
!> P^-1 makes a large motion of the part of r on N, whose round-off M does not cancel. This part is
!> taken away first, as a force K N c, which changes nothing: the powers of P^-1 eps K, applied to
!> P^-1 r, tend to N c.
module massless_acceleration
  use kinds, only: rk
  use errors, only: error_type
  use matrix_pattern, only: pattern
  use global_vectors, only: dot, multiply, diagonal, largest_entry, total
  use linear_solver, only: equation_solver
  use solver_catalogue, only: make_solver, symmetric_solver
  use initial_acceleration, only: find_massive
  implicit none
  private
  public :: find_constrained_acceleration, find_weight, leave_out_fast

  !> eps times the mean square frequency of the unknowns with mass. Measured on an arch dam on a
  !> perimetral joint, 800 times as stiff as the elements: 1e-3 takes 43 iterations, 1e-5 takes 6,
  !> 1e-7 takes 3 and loses three digits, for the condition of P grows with 1/eps.
  real(rk), parameter :: share_of_stiffness = 1.0e-5_rk
  integer, parameter :: most_iterations = 300
  real(rk), parameter :: largest_growth = 1.0e4_rk !< of the correction over the smallest one
  !> Of the correction, in the norm of M: the end of the iteration, and the largest one accepted
  !> where round-off ends the iteration. Both over the acceleration that the loads alone give.
  real(rk), parameter :: tolerance = 1.0e-12_rk, largest_correction = 1.0e-6_rk
  !> Powers of P^-1 eps K: each takes a factor of some 1e-5 of what has mass.
  integer, parameter :: num_powers = 3
  !> The filter of motions that are too fast: powers of F, and of 1 - F^2.
  integer, parameter :: order_of_filter = 2, num_filters = 13

contains

  !> Solves M a = r with N^T K a = 0. Fails where K holds a massless part by nothing; without an
  !> error the iteration may end without convergence. `worst` is then an unknown of the place.
  subroutine find_constrained_acceleration(matrix, mass, sum_of_both, load, r, a, worst, error)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: mass(:) !< values of M
    real(rk), intent(in) :: sum_of_both(:) !< values of P = M + eps K, closed joints in K
    real(rk), intent(in) :: load(:) !< (num_total) part of r that sets the tolerance [N]
    real(rk), intent(in) :: r(:) !< (num_total) [N]
    real(rk), intent(out) :: a(:) !< (num_total) zero on prescribed unknowns [m/s2]
    integer, intent(out) :: worst !< 0: none, -1: on another rank
    type(error_type), allocatable, intent(out) :: error
    class(equation_solver), allocatable :: solver
    real(rk) :: own(size(r)), reference(size(r)) ! r and load without their parts on N
    a = 0.0_rk
    call factor_of(matrix, sum_of_both, solver, worst, error)
    if (allocated(error)) return
    own = r
    reference = load
    call take_static_part(matrix, mass, sum_of_both, solver, own, error)
    if (allocated(error)) return
    call take_static_part(matrix, mass, sum_of_both, solver, reference, error)
    if (allocated(error)) return
    call iterate(matrix, mass, solver, reference, own, a, worst, error)
  end subroutine find_constrained_acceleration

  !> A solver with the factor of a matrix; `worst` is the unknown at which it is singular, or 0.
  subroutine factor_of(matrix, values, solver, worst, error)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: values(:)
    class(equation_solver), allocatable, intent(out) :: solver
    integer, intent(out) :: worst
    type(error_type), allocatable, intent(out) :: error
    worst = 0
    call make_solver(symmetric_solver, solver, error, matrix%is_shared)
    if (.not. allocated(error)) call solver%analyse(matrix, error)
    if (allocated(error)) return
    call solver%factorise(matrix, values, error)
    worst = solver%failed_unknown
  end subroutine factor_of

  !> Solves for the free unknowns; x is zero on the prescribed ones.
  subroutine solve_free(matrix, solver, force, x, error)
    type(pattern), intent(in) :: matrix
    class(equation_solver), intent(inout) :: solver
    real(rk), intent(in) :: force(:) !< (num_total)
    real(rk), intent(out) :: x(:) !< (num_total)
    type(error_type), allocatable, intent(out) :: error
    real(rk) :: column(matrix%num_free, 1)
    x = 0.0_rk
    column(:, 1) = force(:matrix%num_free)
    call solver%solve(column, error)
    if (.not. allocated(error)) x(:matrix%num_free) = column(:, 1)
  end subroutine solve_free

  !> Takes from a force what a static displacement of the massless part takes: eps K N c.
  subroutine take_static_part(matrix, mass, sum_of_both, solver, force, error)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: mass(:) !< values of M
    real(rk), intent(in) :: sum_of_both(:) !< values of P
    class(equation_solver), intent(inout) :: solver !< of P
    real(rk), intent(inout) :: force(:) !< (num_total) [N]
    type(error_type), allocatable, intent(out) :: error
    real(rk), dimension(size(force)) :: moved, product, x
    integer :: i
    call solve_free(matrix, solver, force, moved, error)
    do i = 1, num_powers
      if (allocated(error)) return
      call multiply(matrix, mass, moved, product)
      call solve_free(matrix, solver, product, x, error)
      moved = moved - x
    end do
    if (allocated(error)) return
    call multiply(matrix, sum_of_both - mass, moved, product)
    force = force - product
  end subroutine take_static_part

  !> Takes the part of motions whose frequencies w are high from an acceleration:
  !>
  !>   a <- (1 - (1 - F^2)^13) a,   F = (M + tau K)^-1 M
  !>
  !> Slow motions lose (2 tau w^2)^13 of their part, fast ones keep 13/(tau w^2)^2. A facet that a
  !> tie covers in part has motions with nearly no mass. N^T K a = 0 still holds.
  subroutine leave_out_fast(matrix, mass, tau, stiffness, a, error)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: mass(:) !< values of M
    real(rk), intent(in) :: tau !< [s2]
    real(rk), intent(in) :: stiffness(:) !< values of K, closed joints in it
    real(rk), intent(inout) :: a(:) !< (num_total) zero on prescribed unknowns [m/s2]
    type(error_type), allocatable, intent(out) :: error
    class(equation_solver), allocatable :: solver
    real(rk), dimension(size(a)) :: fast, slow, product
    integer :: i, k, worst
    call factor_of(matrix, mass + tau*stiffness, solver, worst, error)
    fast = a
    do i = 1, num_filters
      slow = fast
      do k = 1, order_of_filter
        if (allocated(error)) return
        call multiply(matrix, mass, slow, product)
        call solve_free(matrix, solver, product, slow, error)
      end do
      fast = fast - slow
    end do
    if (allocated(error)) return
    a = a - fast
  end subroutine leave_out_fast

  !> eps: a share of mass over stiffness, summed over the unknowns with mass; 0 without any mass.
  subroutine find_weight(matrix, mass, stiffness, eps)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: mass(:), stiffness(:)
    real(rk), intent(out) :: eps !< [s2]
    real(rk), dimension(matrix%num_total) :: m, k
    real(rk) :: mass_in_all
    logical, allocatable :: is_massive(:)
    call diagonal(matrix, mass, m)
    call diagonal(matrix, stiffness, k)
    call find_massive(matrix, m, is_massive)
    eps = 0.0_rk
    m = merge(m, 0.0_rk, is_massive)
    k = merge(k, 0.0_rk, is_massive)
    mass_in_all = total(matrix%part, m)
    if (mass_in_all > 0.0_rk) eps = share_of_stiffness*mass_in_all/total(matrix%part, k)
  end subroutine find_weight

  !> Conjugate gradients for M a = r with the preconditioner P^-1 M P^-1. Round-off of a large
  !> static force on the massless part ends the decrease: the best iterate is the answer.
  subroutine iterate(matrix, mass, solver, load, r, a, worst, error)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: mass(:)
    class(equation_solver), intent(inout) :: solver !< of P
    real(rk), intent(in) :: load(:), r(:)
    real(rk), intent(inout) :: a(:)
    integer, intent(inout) :: worst
    type(error_type), allocatable, intent(out) :: error
    real(rk), dimension(matrix%num_total) :: rest, z, p, product, now
    real(rk) :: reference, last_size, size_of_rest, smallest_size, curvature
    integer :: i
    call precondition(matrix, mass, solver, load, z, reference, error)
    if (allocated(error)) return
    rest = r
    p = 0.0_rk
    now = 0.0_rk
    last_size = huge(1.0_rk)
    smallest_size = huge(1.0_rk)
    do i = 0, most_iterations
      call precondition(matrix, mass, solver, rest, z, size_of_rest, error)
      if (allocated(error)) return
      if (i == 0) reference = max(reference, size_of_rest)
      if (size_of_rest < smallest_size) then
        smallest_size = size_of_rest
        a = now
      end if
      if (size_of_rest <= tolerance**2*reference &
          .or. size_of_rest > largest_growth**2*smallest_size) exit
      p = z + size_of_rest/last_size*p
      call multiply(matrix, mass, p, product)
      curvature = dot(matrix%part, p, product)
      if (.not. curvature > 0.0_rk) exit
      now = now + size_of_rest/curvature*p
      rest = rest - size_of_rest/curvature*product
      last_size = size_of_rest
    end do
    if (smallest_size > largest_correction**2*reference) worst = place_of_largest(matrix, z)
  end subroutine iterate

  !> The unknown of the largest entry; -1 on ranks that do not have it.
  integer function place_of_largest(matrix, z) result(place)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: z(:) !< (num_total)
    real(rk) :: largest
    largest = largest_entry(matrix%part, abs(z))
    place = -1
    if (size(z) > 0 .and. .not. maxval(abs(z)) < largest) place = max(1, maxloc(abs(z), 1))
  end function place_of_largest

  !> z = P^-1 M P^-1 rest, and rest . z.
  subroutine precondition(matrix, mass, solver, rest, z, size_of_rest, error)
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: mass(:)
    class(equation_solver), intent(inout) :: solver
    real(rk), intent(in) :: rest(:)
    real(rk), intent(out) :: z(:), size_of_rest
    type(error_type), allocatable, intent(out) :: error
    real(rk), dimension(size(rest)) :: half, product
    z = 0.0_rk
    size_of_rest = 0.0_rk
    call solve_free(matrix, solver, rest, half, error)
    if (allocated(error)) return
    call multiply(matrix, mass, half, product)
    size_of_rest = dot(matrix%part, half, product)
    call solve_free(matrix, solver, product, z, error)
  end subroutine precondition
end module massless_acceleration
