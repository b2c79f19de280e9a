!> The error of the mesh in a principal stress at one node: the stress that a run reports there, the
!> mean of the elements around the node, against those of fits (theory.md, 14.6). Where solids lie
!> three deep, quadratic fits of the elements around the place: of their means, up to the third
!> ring, and of all points of two rings. Elsewhere linear ones, of the elements around the node that
!> has most of them, among those that share an element with the place (Zienkiewicz & Zhu, Int. J.
!> Num. Meth. Engng 33 (1992) 1331).
module place_errors
  use dam_mesh, only: fe_mesh
  use kinds, only: rk
  use analysis_state, only: state
  use problem_definition, only: problem
  use solid_layers, only: has_three_layers
  use stress_fields, only: recovered_fields
  use stress_polynomials, only: stress_polynomial, linear_terms, quadratic_terms
  use tensor6, only: principal_values
  implicit none
  private
  public :: error_at_node, not_known, left_elasticity, bounded_by_law

  !> In place of an error. The law of a solid bounds its stress at a singular place before the solid
  !> has left elasticity there, too.
  real(rk), parameter :: not_known = -1.0_rk, left_elasticity = -2.0_rk, bounded_by_law = -3.0_rk

  !> The means of one curved layer of elements lie nearly in a plane and do not determine a stress
  !> across the layer: a fit that makes differences grow by more is not used. Fits of bricks in
  !> several layers, and of slices, have 0.2 to 2.6, single layers of arches 100 to 900.
  real(rk), parameter :: largest_growth = 5.0_rk

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
    logical, allocatable :: is_near(:), is_second(:), is_third(:)
    integer, allocatable :: solids(:)
    integer :: s
    error = not_known
    call stresses%need_smoothing(model)
    call list_patches(stresses, node, patches)
    if (size(patches) == 0) return
    allocate (is_near(stresses%smoothing%num_patches), source=.false.)
    is_near(patches) = .true.
    call list_solids(stresses, is_near, is_second)
    call add_patches(stresses, is_second, is_near)
    call list_solids(stresses, is_near, is_third)
    solids = pack([(s, s=1, size(is_third))], is_third)
    if (.not. is_deep(stresses, solids, node)) is_third = is_second
    call stresses%need_points_of(model, now, is_third)
    if (any(stresses%is_inelastic .and. is_second)) error = left_elasticity
    if (error < not_known) return
    if (count(is_third) > count(is_second) .and. .not. any(stresses%is_inelastic .and. is_third)) &
      then
      error = quadratic_error(model%mesh, stresses, is_second, is_third, node, number)
    end if
    if (error < 0.0_rk) error = linear_error(model%mesh, stresses, patches, is_second, node, number)
  end function error_at_node

  !> The patches (a node with the solids of one kind of material) of the solids in the mean of a
  !> node.
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

  !> Adds the patches of some solids.
  pure subroutine add_patches(stresses, is_wanted, is_near)
    type(recovered_fields), intent(in) :: stresses
    logical, intent(in) :: is_wanted(:) !< (solids)
    logical, intent(inout) :: is_near(:) !< (patches)
    integer :: s
    do s = 1, size(is_wanted)
      if (is_wanted(s)) is_near(stresses%smoothing%patch(:, s)) = .true.
    end do
  end subroutine add_patches

  !> Whether the solids around a node lie three deep.
  pure logical function is_deep(stresses, solids, node)
    type(recovered_fields), intent(in) :: stresses
    integer, intent(in) :: solids(:), node
    integer :: i
    is_deep = .true.
    associate (plan => stresses%plan)
      do i = plan%node_start(node), plan%node_start(node + 1) - 1
        is_deep = is_deep .and. &
                  has_three_layers(stresses%smoothing%patch, solids, (plan%corner(i) - 1)/8 + 1)
      end do
    end associate
  end function is_deep

  !> The distance to quadratic fits at the node, and how far the fit exceeds the value at the nodes
  !> beside: the largest stress may lie there. `not_known` where the means do not determine the fit.
  real(rk) function quadratic_error(mesh, stresses, is_second, is_third, node, number) &
    result(error)
    type(fe_mesh), intent(in) :: mesh
    type(recovered_fields), intent(in) :: stresses
    logical, intent(in) :: is_second(:), is_third(:) !< (solids) rings around the node
    integer, intent(in) :: node, number
    type(stress_polynomial) :: of_means, of_points
    real(rk) :: own
    integer :: a, e, i, s
    of_means%num_terms = quadratic_terms
    of_means%origin = mesh%x(:, node)
    of_means%length = sum(stresses%smoothing%volume, &
                          mask=spread(is_second, 1, 8))**(1.0_rk/3.0_rk)
    of_points = of_means
    do s = 1, size(is_third)
      if (is_third(s)) call of_means%add_solid(mesh, stresses, s, by_means=.true.)
      if (is_second(s)) call of_points%add_solid(mesh, stresses, s, by_means=.false.)
    end do
    own = value_of(stresses%node_stress(:, node), number)
    call of_means%solve()
    error = not_known
    if (of_means%growth_at(mesh%x(:, node)) > largest_growth) return
    error = abs(value_of(of_means%value_at(mesh%x(:, node)), number) - own)
    associate (plan => stresses%plan)
      do i = plan%node_start(node), plan%node_start(node + 1) - 1
        s = (plan%corner(i) - 1)/8 + 1
        e = plan%element_of_solid(s)
        do a = 1, 8
          associate (beside => mesh%x(:, mesh%nodes(a, e)))
            if (of_means%growth_at(beside) > largest_growth) cycle
            error = max(error, excess(value_of(of_means%value_at(beside), number), own, number))
          end associate
        end do
      end do
      if (any(plan%num_points == 1 .and. is_second)) return
    end associate
    call of_points%solve()
    error = max(error, abs(value_of(of_points%value_at(mesh%x(:, node)), number) - own))
  end function quadratic_error

  !> How far a stress is beyond the extreme.
  pure real(rk) function excess(value, own, number)
    real(rk), intent(in) :: value, own !< [Pa]
    integer, intent(in) :: number !< 1: the largest, 3: the smallest
    excess = merge(value - own, own - value, number == 1)
  end function excess

  !> A principal value.
  pure real(rk) function value_of(stress, number)
    real(rk), intent(in) :: stress(6) !< [Pa]
    integer, intent(in) :: number
    real(rk) :: values(3)
    values = principal_values(stress)
    value_of = values(number)
  end function value_of

  !> The distance to linear fits at the node, of all points and of means.
  real(rk) function linear_error(mesh, stresses, patches, is_wanted, node, number) result(error)
    type(fe_mesh), intent(in) :: mesh
    type(recovered_fields), intent(in) :: stresses
    integer, intent(in) :: patches(:)
    logical, intent(in) :: is_wanted(:) !< (solids)
    integer, intent(in) :: node, number
    real(rk) :: own
    own = value_of(stresses%node_stress(:, node), number)
    error = not_known
    call take_fit(by_means=.true.)
    call take_fit(by_means=.false.)
  contains
    !> Takes the distance to a fit that its stresses determine.
    subroutine take_fit(by_means)
      logical, intent(in) :: by_means
      real(rk) :: stress(6), growth
      call fit_at(mesh, stresses, patches, is_wanted, by_means, node, stress, growth)
      if (growth <= largest_growth) error = max(error, abs(value_of(stress, number) - own))
    end subroutine take_fit
  end function linear_error

  !> The stress at a node: the mean of the linear fits of the patches with most solids.
  subroutine fit_at(mesh, stresses, patches, is_wanted, by_means, node, stress, growth)
    type(fe_mesh), intent(in) :: mesh
    type(recovered_fields), intent(in) :: stresses
    integer, intent(in) :: patches(:)
    logical, intent(in) :: is_wanted(:) !< (solids)
    logical, intent(in) :: by_means !< of the elements, else by all points
    integer, intent(in) :: node
    real(rk), intent(out) :: stress(6) !< [Pa]
    real(rk), intent(out) :: growth !< of differences, of the worst fit
    type(stress_polynomial) :: fit(size(patches)), empty
    integer :: num_solids(size(patches))
    integer :: a, k, s
    empty%num_terms = linear_terms
    empty%origin = mesh%x(:, node)
    empty%length = sum(stresses%smoothing%volume, mask=spread(is_wanted, 1, 8))**(1.0_rk/3.0_rk)
    fit = empty
    num_solids = 0
    do s = 1, size(is_wanted)
      if (.not. is_wanted(s)) cycle
      do a = 1, 8
        k = findloc(patches, stresses%smoothing%patch(a, s), dim=1)
        if (k == 0) cycle
        num_solids(k) = num_solids(k) + 1
        call fit(k)%add_solid(mesh, stresses, s, by_means)
      end do
    end do
    stress = 0.0_rk
    growth = 0.0_rk
    do k = 1, size(patches)
      if (num_solids(k) < maxval(num_solids)) cycle
      growth = max(growth, fit(k)%growth_at(mesh%x(:, node)))
      call fit(k)%solve()
      stress = stress + fit(k)%value_at(mesh%x(:, node))
    end do
    stress = stress/count(num_solids == maxval(num_solids))
  end subroutine fit_at
end module place_errors
