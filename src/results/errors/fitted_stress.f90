!> A smooth stress from linear fits around nodes (theory.md, 14.2). Nodes of a surface take the fits
!> of nodes inside. Source: Zienkiewicz & Zhu, Int. J. Num. Meth. Engng 33 (1992) 1331.
module fitted_stress
  use dam_mesh, only: fe_mesh
  use kinds, only: rk
  use shape_hex8, only: point_shape
  use small_matrix, only: solve_dense
  use stress_error, only: smoothing_plan
  use recovery_plans, only: max_points, recovery_plan
  implicit none
  private
  public :: patch_fit, make_patch_fit, fit_stress

  integer, parameter :: terms = 4 !< 1, x, y, z

  !> What the fits need of the mesh. A patch is a node with the solids of one kind
  !> of material around it.
  type :: patch_fit
    real(rk), allocatable :: x(:, :) !< (3, patches) the node [m]
    real(rk), allocatable :: size(:) !< (patches) of its solids [m]
    integer, allocatable :: num_solids(:) !< (patches)
    integer, allocatable :: most(:) !< (patches) solids of the richest patch that shares a solid
    logical, allocatable :: is_used(:) !< (patches) whether a patch takes its fit
    real(rk), allocatable :: normal(:, :, :) !< (terms, terms, patches) sums of products of terms
  end type patch_fit

contains

  !> Finds the patches and their normal equations.
  subroutine make_patch_fit(mesh, plan, smoothing, fit)
    type(fe_mesh), intent(in) :: mesh
    type(recovery_plan), intent(in) :: plan
    type(smoothing_plan), intent(in) :: smoothing
    type(patch_fit), intent(out) :: fit
    real(rk) :: x(3, max_points), centre(3), spreading(3, 3), own(terms)
    integer :: i, p, s
    call measure_patches(mesh, plan, smoothing, fit)
    call find_used(plan, smoothing, fit)
    allocate (fit%normal(terms, terms, smoothing%num_patches), source=0.0_rk)
    do s = 1, plan%num_solids
      x = points_of(mesh, plan%element_of_solid(s))
      centre = sum(x, dim=2)/max_points
      x = x - spread(centre, 2, max_points)
      spreading = matmul(x, transpose(x))
      do i = 1, 8
        p = smoothing%patch(i, s)
        own = terms_at(fit, p, centre)
        fit%normal(:, :, p) = fit%normal(:, :, p) &
                              + max_points*spread(own, 1, terms)*spread(own, 2, terms)
        fit%normal(2:, 2:, p) = fit%normal(2:, 2:, p) + spreading/fit%size(p)**2
      end do
    end do
  end subroutine make_patch_fit

  !> Finds the richest patches beside each patch.
  subroutine find_used(plan, smoothing, fit)
    type(recovery_plan), intent(in) :: plan
    type(smoothing_plan), intent(in) :: smoothing
    type(patch_fit), intent(inout) :: fit
    integer :: i, k, most, s
    allocate (fit%most(smoothing%num_patches), source=0)
    allocate (fit%is_used(smoothing%num_patches), source=.false.)
    do s = 1, plan%num_solids
      most = maxval(fit%num_solids(smoothing%patch(:, s)))
      do i = 1, 8
        fit%most(smoothing%patch(i, s)) = max(fit%most(smoothing%patch(i, s)), most)
      end do
    end do
    do s = 1, plan%num_solids
      associate (patch => smoothing%patch(:, s))
        do i = 1, 8
          do k = 1, 8
            if (takes(fit, patch(i), patch(k))) fit%is_used(patch(k)) = .true.
          end do
        end do
      end associate
    end do
  end subroutine find_used

  !> Whether a patch takes the fit of another one that shares a solid with it.
  pure logical function takes(fit, patch, other)
    type(patch_fit), intent(in) :: fit
    integer, intent(in) :: patch, other
    takes = fit%num_solids(other) == fit%most(patch)
    if (fit%num_solids(patch) == fit%most(patch)) takes = other == patch
  end function takes

  !> Place, size and number of solids of each patch.
  subroutine measure_patches(mesh, plan, smoothing, fit)
    type(fe_mesh), intent(in) :: mesh
    type(recovery_plan), intent(in) :: plan
    type(smoothing_plan), intent(in) :: smoothing
    type(patch_fit), intent(inout) :: fit
    integer :: i, p, s
    allocate (fit%x(3, smoothing%num_patches), fit%size(smoothing%num_patches), source=0.0_rk)
    allocate (fit%num_solids(smoothing%num_patches), source=0)
    do s = 1, plan%num_solids
      do i = 1, 8
        p = smoothing%patch(i, s)
        fit%x(:, p) = mesh%x(:, mesh%nodes(i, plan%element_of_solid(s)))
        fit%num_solids(p) = fit%num_solids(p) + 1
        fit%size(p) = fit%size(p) + sum(smoothing%volume(:, s))
      end do
    end do
    fit%size = (fit%size/fit%num_solids)**(1.0_rk/3.0_rk)
  end subroutine measure_patches

  !> The 2 x 2 x 2 points of an element [m].
  pure function points_of(mesh, element) result(x)
    type(fe_mesh), intent(in) :: mesh
    integer, intent(in) :: element
    real(rk) :: x(3, max_points)
    x = matmul(mesh%x(:, mesh%nodes(:, element)), point_shape)
  end function points_of

  !> The terms of a patch at a place.
  pure function terms_at(fit, patch, x) result(own)
    type(patch_fit), intent(in) :: fit
    integer, intent(in) :: patch
    real(rk), intent(in) :: x(3) !< [m]
    real(rk) :: own(terms)
    own(1) = 1.0_rk
    own(2:) = (x - fit%x(:, patch))/fit%size(patch)
  end function terms_at

  !> The fitted stress at each patch.
  subroutine fit_stress(mesh, plan, smoothing, fit, stress, smooth)
    type(fe_mesh), intent(in) :: mesh
    type(recovery_plan), intent(in) :: plan
    type(smoothing_plan), intent(in) :: smoothing
    type(patch_fit), intent(in) :: fit
    real(rk), intent(in) :: stress(:, :, :) !< (6, max_points, solids) [Pa]
    real(rk), allocatable, intent(out) :: smooth(:, :) !< (6, patches) [Pa]
    real(rk), allocatable :: slope(:, :, :)
    call solve_patches(mesh, plan, smoothing, fit, stress, slope)
    call evaluate_patches(plan, smoothing, fit, slope, smooth)
  end subroutine fit_stress

  !> The coefficients of the fits, by least squares over the points of the solids of a patch.
  subroutine solve_patches(mesh, plan, smoothing, fit, stress, slope)
    type(fe_mesh), intent(in) :: mesh
    type(recovery_plan), intent(in) :: plan
    type(smoothing_plan), intent(in) :: smoothing
    type(patch_fit), intent(in) :: fit
    real(rk), intent(in) :: stress(:, :, :) !< (6, max_points, solids) [Pa]
    real(rk), allocatable, intent(out) :: slope(:, :, :) !< (terms, 6, patches) [Pa]
    real(rk) :: x(3, max_points), centre(3), total(6), moment(3, 6), found(terms, 6)
    logical :: is_singular
    integer :: i, k, p, s
    allocate (slope(terms, 6, smoothing%num_patches), source=0.0_rk)
    do s = 1, plan%num_solids
      x = points_of(mesh, plan%element_of_solid(s))
      centre = sum(x, dim=2)/max_points
      total = sum(stress(:, :, s), dim=2)
      moment = matmul(x - spread(centre, 2, max_points), transpose(stress(:, :, s)))
      do i = 1, 8
        p = smoothing%patch(i, s)
        if (.not. fit%is_used(p)) cycle
        slope(1, :, p) = slope(1, :, p) + total
        do k = 1, 3
          slope(k + 1, :, p) = slope(k + 1, :, p) &
                               + (moment(k, :) + (centre(k) - fit%x(k, p))*total)/fit%size(p)
        end do
      end do
    end do
    do p = 1, smoothing%num_patches
      if (.not. fit%is_used(p)) cycle
      call solve_dense(fit%normal(:, :, p), slope(:, :, p), found, is_singular)
      slope(:, :, p) = found
      if (is_singular) slope(:, :, p) = 0.0_rk
    end do
  end subroutine solve_patches

  !> The stress at each patch: the mean of the fits of the richest patches that share a solid with
  !> it; the own fit where none is richer.
  subroutine evaluate_patches(plan, smoothing, fit, slope, smooth)
    type(recovery_plan), intent(in) :: plan
    type(smoothing_plan), intent(in) :: smoothing
    type(patch_fit), intent(in) :: fit
    real(rk), intent(in) :: slope(:, :, :) !< (terms, 6, patches) [Pa]
    real(rk), allocatable, intent(out) :: smooth(:, :) !< (6, patches) [Pa]
    integer, allocatable :: num_fits(:)
    integer :: i, k, p, rich, s
    allocate (smooth(6, smoothing%num_patches), source=0.0_rk)
    allocate (num_fits(smoothing%num_patches), source=0)
    do s = 1, plan%num_solids
      do i = 1, 8
        p = smoothing%patch(i, s)
        do k = 1, 8
          rich = smoothing%patch(k, s)
          if (.not. takes(fit, p, rich)) cycle
          smooth(:, p) = smooth(:, p) + matmul(terms_at(fit, rich, fit%x(:, p)), slope(:, :, rich))
          num_fits(p) = num_fits(p) + 1
        end do
      end do
    end do
    do p = 1, smoothing%num_patches
      smooth(:, p) = smooth(:, p)/num_fits(p)
    end do
  end subroutine evaluate_patches
end module fitted_stress
