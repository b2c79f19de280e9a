!> Anderson acceleration of an iteration s <- g(s): the next s is the combination of the last
!> iterates with the smallest change g(s) - s. For a linear g this is GMRES on s = g(s). Where g has
!> kinks and the change grows, g is no longer what it was at the earlier iterates: the acceleration
!> may then start afresh.
module anderson_mixing
  use kinds, only: rk
  use global_vectors, only: dot, norm
  use small_matrix, only: solve_dense
  use unknown_parts, only: unknown_part
  implicit none
  private
  public :: mixer

  integer, parameter :: most_pairs = 8 !< pairs of differences that are kept
  !> Differences are left out if they are linearly dependent to this fraction.
  real(rk), parameter :: least_angle = 1.0e-10_rk

  !> Iterations after a fresh start that may increase the change: each adds a direction in which a
  !> plain iteration diverges.
  integer, parameter :: first_iterations = 4

  type :: mixer
    integer, allocatable :: rows(:) !< unknowns that change; not allocated: all
    type(unknown_part) :: part !< own ones of these, where vectors are divided
    logical :: starts_afresh = .false. !< where the change grows
    integer :: num_pairs = 0
    !> (rows, pairs) differences of s and of g(s) - s
    real(rk), allocatable :: ds(:, :), df(:, :)
    real(rk), allocatable :: last_s(:), last_f(:) !< (rows)
    real(rk), private :: gram(most_pairs, most_pairs) = 0.0_rk !< products of df
    integer, private :: next = 1 !< column that the next pair overwrites
    integer, private :: age = huge(1) !< iterations since a fresh start, if there was one
  contains
    procedure :: forget, choose_rows
    procedure :: advance => mix_iterates
  end type mixer

contains

  !> Chooses the unknowns that change.
  subroutine choose_rows(self, part, rows)
    class(mixer), intent(inout) :: self
    type(unknown_part), intent(in) :: part
    integer, intent(in) :: rows(:) !< ascending
    self%rows = rows
    self%part = part%of_rows(rows)
  end subroutine choose_rows

  !> Discards all pairs.
  subroutine forget(self)
    class(mixer), intent(inout) :: self
    self%num_pairs = 0
    self%next = 1
    self%age = huge(1)
    if (allocated(self%last_s)) deallocate (self%last_s, self%last_f)
  end subroutine forget

  !> Replaces s by the next iterate.
  subroutine mix_iterates(self, f, s)
    class(mixer), intent(inout) :: self
    real(rk), intent(in) :: f(:) !< g(s) - s
    real(rk), intent(inout) :: s(:)
    real(rk), allocatable :: next(:)
    if (allocated(self%rows)) then
      next = s(self%rows)
      call mix_rows(self, f(self%rows), next)
      s(self%rows) = next
    else
      call mix_rows(self, f, s)
    end if
  end subroutine mix_iterates

  !> The same for the rows that change.
  subroutine mix_rows(self, f, s)
    type(mixer), intent(inout) :: self
    real(rk), intent(in) :: f(:)
    real(rk), intent(inout) :: s(:)
    real(rk) :: weight(most_pairs)
    real(rk), allocatable :: here(:)
    integer :: k
    if (self%age > first_iterations) then
      call start_afresh(self, f)
    else
      self%age = self%age + 1
    end if
    if (allocated(self%last_s)) call keep_pair(self, f, s)
    here = s
    call find_weights(self, f, weight)
    s = s + f
    do k = 1, self%num_pairs
      s = s - weight(k)*(self%ds(:, k) + self%df(:, k))
    end do
    self%last_s = here
    self%last_f = f
  end subroutine mix_rows

  !> Discards all pairs if the change has grown.
  subroutine start_afresh(self, f)
    type(mixer), intent(inout) :: self
    real(rk), intent(in) :: f(:) !< the present change
    if (.not. (self%starts_afresh .and. allocated(self%last_f))) return
    if (norm(self%part, f) <= norm(self%part, self%last_f)) return
    call self%forget()
    self%age = 0
  end subroutine start_afresh

  !> Stores the difference to the last iterate in place of the oldest difference.
  subroutine keep_pair(self, f, s)
    type(mixer), intent(inout) :: self
    real(rk), intent(in) :: f(:), s(:)
    integer :: k
    if (allocated(self%ds)) then
      if (size(self%ds, 1) /= size(s)) deallocate (self%ds, self%df)
    end if
    if (.not. allocated(self%ds)) then
      allocate (self%ds(size(s), most_pairs), self%df(size(s), most_pairs))
    end if
    self%ds(:, self%next) = s - self%last_s
    self%df(:, self%next) = f - self%last_f
    self%num_pairs = max(self%num_pairs, self%next)
    do k = 1, self%num_pairs
      self%gram(k, self%next) = dot(self%part, self%df(:, k), self%df(:, self%next))
      self%gram(self%next, k) = self%gram(k, self%next)
    end do
    self%next = 1 + mod(self%next, most_pairs)
  end subroutine keep_pair

  !> Weights that minimise |f - df*weight|, by the normal equations.
  subroutine find_weights(self, f, weight)
    type(mixer), intent(in) :: self
    real(rk), intent(in) :: f(:)
    real(rk), intent(out) :: weight(:)
    real(rk) :: gram(self%num_pairs, self%num_pairs), right(self%num_pairs, 1)
    real(rk) :: x(self%num_pairs, 1), scale(self%num_pairs)
    integer :: j
    logical :: is_singular
    weight = 0.0_rk
    if (self%num_pairs == 0) return
    gram = self%gram(:self%num_pairs, :self%num_pairs)
    do j = 1, self%num_pairs
      scale(j) = 1.0_rk/max(sqrt(gram(j, j)), tiny(1.0_rk))
      right(j, 1) = scale(j)*dot(self%part, self%df(:, j), f)
    end do
    do j = 1, self%num_pairs
      gram(:, j) = gram(:, j)*scale*scale(j)
      gram(j, j) = gram(j, j) + least_angle
    end do
    call solve_dense(gram, right, x, is_singular)
    if (.not. is_singular) weight(:self%num_pairs) = x(:, 1)*scale
  end subroutine find_weights
end module anderson_mixing
