!> The error of the mesh in a principal stress at one node: the stress that a run reports there, the
!> mean of the elements around the node, against those of linear fits (theory.md, 14.6). A fit uses
!> the elements around the node that has most of them, among those that share an element with the
!> place, once with all their points and once with their means (Zienkiewicz & Zhu, Int. J. Num.
!> Meth. Engng 33 (1992) 1331).
module place_errors
  use dam_mesh, only: fe_mesh
  use kinds, only: rk
  use analysis_state, only: state
  use problem_definition, only: problem
  use shape_hex8, only: point_shape
  use small_matrix, only: solve_dense
  use stress_fields, only: recovered_fields
  use stress_recovery, only: max_points
  use tensor6, only: principal_values
  implicit none
  private
  public :: error_at_node, not_known, left_elasticity

  !> In place of an error.
  real(rk), parameter :: not_known = -1.0_rk, left_elasticity = -2.0_rk

  integer, parameter :: terms = 4 !< 1, x, y, z
  !> Added to the squares of the slopes, over the number of points: a direction in which all points
  !> are level has none.
  real(rk), parameter :: share = 1.0e-9_rk

contains

  !> The error of a principal stress on a node [Pa]. The stresses on the nodes belong to this
  !> increment.
  real(rk) function error_at_node(model, now, stresses, node, number) result(error)
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(recovered_fields), intent(inout) :: stresses
    integer, intent(in) :: node
    integer, intent(in) :: number !< 1: the largest, 3: the smallest
    integer, allocatable :: patches(:)
    logical, allocatable :: is_near(:), is_wanted(:)
    real(rk) :: fitted(3), own(3)
    integer :: i
    error = not_known
    call stresses%need_smoothing(model)
    call list_patches(stresses, node, patches)
    if (size(patches) == 0) return
    allocate (is_near(stresses%smoothing%num_patches), source=.false.)
    is_near(patches) = .true.
    call list_solids(stresses, is_near, is_wanted)
    call stresses%need_points_of(model, now, is_wanted)
    if (any(stresses%is_inelastic .and. is_wanted)) error = left_elasticity
    if (error < not_known) return
    own = principal_values(stresses%node_stress(:, node))
    do i = 1, 2
      fitted = principal_values(fit_at(model%mesh, stresses, patches, is_wanted, i == 1, node))
      error = max(error, abs(fitted(number) - own(number)))
    end do
  end function error_at_node

  !> The patches (a node with the solids of one section) of the solids in the mean of a node.
  subroutine list_patches(stresses, node, patches)
    type(recovered_fields), intent(in) :: stresses
    integer, intent(in) :: node
    integer, allocatable, intent(out) :: patches(:)
    integer :: i, k, s
    patches = [integer ::]
    associate (plan => stresses%plan, smoothing => stresses%smoothing)
      do i = plan%node_start(node), plan%node_start(node + 1) - 1
        s = (plan%corner(i) - 1)/8 + 1
        do k = 1, 8
          if (any(patches == smoothing%patch(k, s))) cycle
          patches = [patches, smoothing%patch(k, s)]
        end do
      end do
    end associate
  end subroutine list_patches

  !> The solids of some patches.
  pure subroutine list_solids(stresses, is_near, is_wanted)
    type(recovered_fields), intent(in) :: stresses
    logical, intent(in) :: is_near(:) !< (patches)
    logical, allocatable, intent(out) :: is_wanted(:) !< (solids)
    integer :: s
    allocate (is_wanted(stresses%plan%num_solids))
    do s = 1, size(is_wanted)
      is_wanted(s) = any(is_near(stresses%smoothing%patch(:, s)))
    end do
  end subroutine list_solids

  !> The stress at a node: the mean of the fits of the patches with most solids.
  function fit_at(mesh, stresses, patches, is_wanted, by_means, node) result(stress)
    type(fe_mesh), intent(in) :: mesh
    type(recovered_fields), intent(in) :: stresses
    integer, intent(in) :: patches(:)
    logical, intent(in) :: is_wanted(:) !< (solids)
    logical, intent(in) :: by_means !< of the elements, else by all points
    integer, intent(in) :: node
    real(rk) :: stress(6) !< [Pa]
    real(rk) :: normal(terms, terms, size(patches)), sums(terms, 6, size(patches))
    real(rk) :: own(terms, terms), moment(terms, 6), length
    integer :: num_solids(size(patches))
    integer, allocatable :: solids(:)
    integer :: a, i, k, s
    normal = 0.0_rk
    sums = 0.0_rk
    num_solids = 0
    solids = pack([(s, s=1, size(is_wanted))], is_wanted)
    length = sum(stresses%smoothing%volume(:, solids))**(1.0_rk/3.0_rk)
    do i = 1, size(solids)
      s = solids(i)
      call find_moments(mesh, stresses, s, by_means, mesh%x(:, node), length, own, moment)
      do a = 1, 8
        k = findloc(patches, stresses%smoothing%patch(a, s), dim=1)
        if (k == 0) cycle
        num_solids(k) = num_solids(k) + 1
        normal(:, :, k) = normal(:, :, k) + own
        sums(:, :, k) = sums(:, :, k) + moment
      end do
    end do
    stress = 0.0_rk
    do k = 1, size(patches)
      if (num_solids(k) < maxval(num_solids)) cycle
      stress = stress + fit_of(normal(:, :, k), sums(:, :, k))
    end do
    stress = stress/count(num_solids == maxval(num_solids))
  end function fit_at

  !> A linear stress by least squares, at the origin of its terms.
  function fit_of(normal, sums) result(stress)
    real(rk), intent(in) :: normal(terms, terms), sums(terms, 6)
    real(rk) :: stress(6) !< [Pa]
    real(rk) :: ridged(terms, terms), found(terms, 6)
    logical :: is_singular
    integer :: k
    ridged = normal
    do k = 2, terms
      ridged(k, k) = ridged(k, k) + share*normal(1, 1)
    end do
    call solve_dense(ridged, sums, found, is_singular)
    stress = found(1, :)
    if (is_singular) stress = sums(1, :)/normal(1, 1)
  end function fit_of

  !> The normal equations of the points of a solid, or of its mean.
  pure subroutine find_moments(mesh, stresses, solid, by_means, place, length, normal, sums)
    type(fe_mesh), intent(in) :: mesh
    type(recovered_fields), intent(in) :: stresses
    integer, intent(in) :: solid
    logical, intent(in) :: by_means
    real(rk), intent(in) :: place(3), length !< [m]
    real(rk), intent(out) :: normal(terms, terms), sums(terms, 6)
    real(rk) :: x(3, max_points), stress(6, max_points), own(terms)
    integer :: c, k, q, num_points
    num_points = stresses%plan%num_points(solid)
    stress(:, :num_points) = stresses%point_stress(:, :num_points, solid)
    associate (corners => mesh%x(:, mesh%nodes(:, stresses%plan%element_of_solid(solid))))
      if (by_means .or. num_points == 1) then
        x(:, 1) = sum(corners, dim=2)/max_points
        stress(:, 1) = sum(stress(:, :num_points), dim=2)/num_points
        num_points = 1
      else
        x = matmul(corners, point_shape)
      end if
    end associate
    normal = 0.0_rk
    sums = 0.0_rk
    do q = 1, num_points
      own = [1.0_rk, (x(:, q) - place)/length]
      do k = 1, terms
        normal(:, k) = normal(:, k) + own*own(k)
      end do
      do c = 1, 6
        sums(:, c) = sums(:, c) + own*stress(c, q)
      end do
    end do
  end subroutine find_moments
end module place_errors
