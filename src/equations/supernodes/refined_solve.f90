!> Solves with a factor in single precision, refined in double precision (theory.md, 8).
!>
!> The rounded factor is the preconditioner of conjugate gradients on the matrix itself, which is
!> kept in double precision. Where the matrix is well conditioned one step is enough.
module refined_solve
  use errors, only: error_type, raise
  use global_vectors, only: dot, multiply, norm
  use kinds, only: rk
  use linear_solver, only: equation_solver
  use matrix_pattern, only: pattern
  use write_text, only: as_text
  implicit none
  private
  public :: exact_matrix

  type :: exact_matrix
    type(pattern), private :: matrix
    !> Of the matrix of the factor; not allocated: the factor is in double precision
    real(rk), allocatable, private :: values(:)
    real(rk), allocatable, private :: diagonal(:) !< (free unknowns)
    !> (free unknowns, rank) U: the matrix has the term U U^T
    real(rk), allocatable, private :: low_rank(:, :)
    integer, private :: num_kept = 0
    !> (free unknowns, num_kept) the last solutions, the newest first, and A times them
    real(rk), allocatable, private :: solutions(:, :), forces(:, :)
  contains
    procedure :: round_factor, is_rounded, forget, find_product, smallest_residual
    procedure :: predict, remember
    procedure :: solve => solve_refined
    procedure, private :: correct
  end type exact_matrix

  integer, parameter :: most_steps = 60 !< of conjugate gradients
  integer, parameter :: most_kept = 3 !< solutions
  !> Solutions whose forces differ less from those of newer ones are not used.
  real(rk), parameter :: least_new = 1.0e-6_rk
  !> Residual of a solution that is rounded to double precision, over norm(diag(A) x), and the least
  !> goal of conjugate gradients, whose own residual decreases further.
  real(rk), parameter :: roundoff = 20.0_rk*epsilon(1.0_rk), least_goal = 0.1_rk*epsilon(1.0_rk)

contains

  !> Rounds a factor to single precision, but for the part of it that holds some unknowns, and keeps
  !> the matrix. Without effect on solvers that cannot.
  subroutine round_factor(self, matrix, values, low_rank, unknown, factor)
    class(exact_matrix), intent(inout) :: self
    type(pattern), intent(in) :: matrix !< symmetric
    real(rk), intent(in) :: values(:) !< of the matrix that is factored
    real(rk), allocatable, intent(in) :: low_rank(:, :)
    integer, intent(in) :: unknown(:)
    class(equation_solver), intent(inout) :: factor
    logical :: is_kept
    call self%forget()
    call factor%keep_single(unknown, is_kept)
    if (.not. is_kept) return
    if (.not. allocated(self%matrix%row)) self%matrix = matrix
    self%values = values
    self%diagonal = values(matrix%column_start(:matrix%num_free))
    if (allocated(low_rank)) self%low_rank = low_rank
  end subroutine round_factor

  !> Whether solves with the factor need a refinement.
  pure logical function is_rounded(self)
    class(exact_matrix), intent(in) :: self
    is_rounded = allocated(self%values)
  end function is_rounded

  !> The factor is in double precision again.
  subroutine forget(self)
    class(exact_matrix), intent(inout) :: self
    self%num_kept = 0
    if (allocated(self%values)) deallocate (self%values)
    if (allocated(self%low_rank)) deallocate (self%low_rank)
  end subroutine forget

  !> A x on the free unknowns.
  subroutine find_product(self, x, ax)
    class(exact_matrix), intent(in) :: self
    real(rk), intent(in) :: x(:) !< (free unknowns)
    real(rk), intent(out) :: ax(:) !< (free unknowns)
    real(rk), dimension(self%matrix%num_total) :: q, product
    integer :: k
    q(:size(x)) = x
    q(size(x) + 1:) = 0.0_rk
    call multiply(self%matrix, self%values, q, product)
    ax = product(:size(x))
    if (.not. allocated(self%low_rank)) return
    do k = 1, size(self%low_rank, 2)
      ax = ax + dot(self%low_rank(:, k), x)*self%low_rank(:, k)
    end do
  end subroutine find_product

  !> The combination of the last solutions with the least residual (Fischer 1998): what is left to
  !> be solved for is small, and so is what single precision leaves of it.
  subroutine predict(self, b, x, ax)
    class(exact_matrix), intent(in) :: self
    real(rk), intent(in) :: b(:) !< (free unknowns)
    real(rk), intent(out) :: x(:), ax(:) !< (free unknowns) solution, and A times it
    real(rk) :: direction(size(b), most_kept), from(size(b), most_kept), r(size(b)), length, share
    integer :: i, k
    x = 0.0_rk
    ax = 0.0_rk
    r = b
    do k = 1, self%num_kept ! the last one first
      direction(:, k) = self%forces(:, k)
      from(:, k) = self%solutions(:, k)
      length = norm(direction(:, k))
      do i = 1, k - 1
        share = dot(direction(:, i), direction(:, k))
        direction(:, k) = direction(:, k) - share*direction(:, i)
        from(:, k) = from(:, k) - share*from(:, i)
      end do
      share = norm(direction(:, k))
      if (.not. share > least_new*length) exit
      direction(:, k) = direction(:, k)/share
      from(:, k) = from(:, k)/share
      share = dot(direction(:, k), r)
      x = x + share*from(:, k)
      ax = ax + share*direction(:, k)
      r = r - share*direction(:, k)
    end do
  end subroutine predict

  !> Keeps a solution and A times it.
  subroutine remember(self, x, ax)
    class(exact_matrix), intent(inout) :: self
    real(rk), intent(in) :: x(:), ax(:) !< (free unknowns)
    integer :: k
    if (.not. allocated(self%solutions)) allocate (self%solutions(size(x), most_kept), &
                                                   self%forces(size(x), most_kept))
    do k = min(self%num_kept, most_kept - 1), 1, -1
      self%solutions(:, k + 1) = self%solutions(:, k)
      self%forces(:, k + 1) = self%forces(:, k)
    end do
    self%solutions(:, 1) = x
    self%forces(:, 1) = ax
    self%num_kept = min(self%num_kept + 1, most_kept)
  end subroutine remember

  !> Norm of the residual that round-off in double precision leaves.
  real(rk) function smallest_residual(self, x)
    class(exact_matrix), intent(in) :: self
    real(rk), intent(in) :: x(:) !< (free unknowns)
    smallest_residual = roundoff*norm(self%diagonal*x)
  end function smallest_residual

  !> Solves A x = b until the norm of the residual is admissible.
  subroutine solve_refined(self, factor, admissible, b, error)
    class(exact_matrix), intent(inout) :: self
    class(equation_solver), intent(inout) :: factor
    real(rk), intent(in) :: admissible !< norm of the residual
    real(rk), intent(inout) :: b(:) !< (free unknowns) the solution on return
    type(error_type), allocatable, intent(out) :: error
    real(rk), dimension(size(b)) :: x, ax, r
    real(rk) :: z(size(b), 1), goal
    call self%predict(b, x, ax)
    z(:, 1) = b - ax
    call factor%solve(z, error)
    if (allocated(error)) return
    x = x + z(:, 1)
    call self%find_product(x, ax)
    r = b - ax
    goal = max(admissible, least_goal*norm(self%diagonal*x))
    if (norm(r) > goal) then
      call self%correct(factor, goal, x, r, error)
      if (allocated(error)) return
      ax = b - r
    end if
    call self%remember(x, ax)
    b = x
  end subroutine solve_refined

  !> Reduces the residual of a solution by conjugate gradients.
  subroutine correct(self, factor, goal, x, r, error)
    class(exact_matrix), intent(in) :: self
    class(equation_solver), intent(inout) :: factor
    real(rk), intent(in) :: goal !< norm of the residual
    real(rk), intent(inout) :: x(:), r(:) !< (free unknowns) solution and residual
    type(error_type), allocatable, intent(out) :: error
    real(rk), dimension(size(x)) :: p, ap, last_r
    real(rk) :: z(size(x), 1), rz, last_rz, step
    integer :: k
    p = 0.0_rk
    last_r = 0.0_rk
    last_rz = 1.0_rk
    do k = 1, most_steps
      z(:, 1) = r
      call factor%solve(z, error)
      if (allocated(error)) return
      rz = dot(z(:, 1), r)
      ! Polak and Ribiere: the preconditioner is not exactly symmetric.
      p = z(:, 1) + (dot(z(:, 1), r - last_r)/last_rz)*p
      last_r = r
      last_rz = rz
      call self%find_product(p, ap)
      if (.not. dot(p, ap) > 0.0_rk) exit
      step = dot(p, r)/dot(p, ap)
      x = x + step*p
      r = r - step*ap
      if (norm(r) <= goal) return
    end do
    call raise(error, 'the factor in single precision does not solve the equations: residual '// &
               as_text(norm(r))//' N after '//as_text(min(k, most_steps))//' steps of '// &
               'refinement, admissible '//as_text(goal)//' N; the matrix is too '// &
               'ill-conditioned for it: leave PRECISION=SINGLE out')
  end subroutine correct
end module refined_solve
