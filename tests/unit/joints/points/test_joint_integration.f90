!> Why joints are integrated at their nodes: the traction of a stiff joint must not oscillate.
!>
!> A strip of 16 solids lies on a joint (k_n 1e13 Pa/m) on rigid ground and is pulled up at one end.
!> The traction should decay smoothly. With Gauss points its sign alternates from point
!> to point, the old finding of Schellekens & de Borst (Int. J. Num. Meth. Engng 36 (1993) 43).
program test_joint_integration
  use dam_mesh, only: fe_mesh
  use element_catalogue, only: make_solid
  use element_formulation, only: solid_element
  use element_joint8, only: build_joint_points
  use element_matrices, only: stiffness_matrices
  use errors, only: error_type
  use joint_points, only: dam_joint
  use kinds, only: rk
  use material_elastic, only: elastic_law
  use testing, only: check, test_log
  implicit none

  interface
    subroutine dposv(uplo, n, nrhs, a, lda, b, ldb, info)
      import :: rk
      implicit none
      character, intent(in) :: uplo
      integer, intent(in) :: n, nrhs, lda, ldb
      real(rk), intent(inout) :: a(lda, n), b(n)
      integer, intent(out) :: info
    end subroutine dposv
  end interface

  integer, parameter :: length = 16, num_upper = 4*(length + 1)
  real(rk), parameter :: stiffness = 1.0e13_rk
  type(test_log) :: log
  real(rk) :: ripple(2)

  log%suite = 'joint_integration'
  call traction_ripple(.true., ripple(1))
  call traction_ripple(.false., ripple(2))
  write (*, '(a,2f8.4)') 'ripple of the traction, nodes and Gauss points: ', ripple
  call check(log, ripple(1) < 1.0e-3_rk, 'nodal points: smooth')
  call check(log, ripple(2) > 0.05_rk, 'Gauss points: oscillating')
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> The strip along x, one solid wide and high; its joint below, the ground's nodes last.
  subroutine strip(mesh)
    type(fe_mesh), intent(out) :: mesh
    integer :: i, n
    mesh%num_nodes = num_upper + 2*(length + 1)
    mesh%num_elements = 2*length
    allocate (mesh%x(3, mesh%num_nodes), mesh%nodes(8, 2*length))
    allocate (mesh%element_type(2*length))
    do i = 0, length
      n = 4*i
      mesh%x(:, n + 1:n + 4) = reshape(real([i, 0, 0, i, 1, 0, i, 0, 1, i, 1, 1], rk), [3, 4])
      mesh%x(:, num_upper + 2*i + 1:num_upper + 2*i + 2) = mesh%x(:, n + 1:n + 2)
    end do
    do i = 1, length
      n = 4*(i - 1)
      mesh%nodes(:, i) = n + [1, 5, 6, 2, 3, 7, 8, 4]
      mesh%nodes(5:, length + i) = n + [1, 5, 6, 2]
      mesh%nodes(:4, length + i) = num_upper + 2*(i - 1) + [1, 3, 4, 2]
    end do
    mesh%element_type = 'C3D8'
    mesh%element_type(length + 1:) = 'JOINT8'
    mesh%node_id = [(i, i=1, mesh%num_nodes)]
    mesh%element_id = [(i, i=1, 2*length)]
  end subroutine strip

  !> Sum of the reversals of the normal traction along the strip over its largest value.
  subroutine traction_ripple(is_nodal, ripple)
    logical, intent(in) :: is_nodal
    real(rk), intent(out) :: ripple
    type(fe_mesh) :: mesh
    type(dam_joint) :: built
    type(error_type), allocatable :: error
    real(rk), allocatable :: k(:, :), u(:), traction(:), x(:)
    integer :: e, info, p
    call strip(mesh)
    call build_joint_points(mesh, [(e, e=length + 1, 2*length)], is_nodal, built, error)
    if (allocated(error)) error stop 2
    allocate (k(3*num_upper, 3*num_upper), source=0.0_rk)
    allocate (u(3*num_upper), source=0.0_rk)
    call add_solids(mesh, k)
    call add_springs(built, k)
    u([9, 12]) = 1.0e6_rk
    call dposv('U', size(u), 1, k, size(u), u, size(u), info)
    if (info /= 0) error stop 3
    allocate (traction(0), x(0))
    do p = 1, built%num_points
      if (built%x(2, p) > 0.4_rk) cycle
      traction = [traction, stiffness*dot_product(slave_weights(built, p), &
                                                  u(3*slave_nodes(built, p)))]
      x = [x, built%x(1, p)]
    end do
    ripple = reversals(x, traction)
  end subroutine traction_ripple

  subroutine add_solids(mesh, k)
    type(fe_mesh), intent(in) :: mesh
    real(rk), intent(inout) :: k(:, :)
    class(solid_element), allocatable :: element
    type(elastic_law) :: law
    real(rk) :: d(6, 6), corners(3, 8, 1), ke(24, 24, 1)
    integer :: e, i, dof(24), status(1)
    law = elastic_law(young=25.0e9_rk, poisson=0.2_rk)
    call law%elastic_stiffness(d)
    call make_solid('C3D8', element)
    do e = 1, length
      corners(:, :, 1) = mesh%x(:, mesh%nodes(:, e))
      call stiffness_matrices(element, corners, d, ke, status)
      do i = 1, 3
        dof(i::3) = 3*mesh%nodes(:, e) - 3 + i
      end do
      k(dof, dof) = k(dof, dof) + ke(:, :, 1)
    end do
  end subroutine add_solids

  !> Springs of the joint in all directions; the ground is fixed.
  subroutine add_springs(built, k)
    type(dam_joint), intent(in) :: built
    real(rk), intent(inout) :: k(:, :)
    integer :: p, a, b, i, row, column
    do p = 1, built%num_points
      do a = built%first(p), built%first_master(p) - 1
        do b = built%first(p), built%first_master(p) - 1
          do i = 1, 3
            row = 3*built%node(a) - 3 + i
            column = 3*built%node(b) - 3 + i
            k(row, column) = k(row, column) &
                             + stiffness*built%area(p)*built%weight(a)*built%weight(b)
          end do
        end do
      end do
    end do
  end subroutine add_springs

  pure function slave_nodes(built, p) result(nodes)
    type(dam_joint), intent(in) :: built
    integer, intent(in) :: p
    integer, allocatable :: nodes(:)
    nodes = built%node(built%first(p):built%first_master(p) - 1)
  end function slave_nodes

  pure function slave_weights(built, p) result(weights)
    type(dam_joint), intent(in) :: built
    integer, intent(in) :: p
    real(rk), allocatable :: weights(:)
    weights = built%weight(built%first(p):built%first_master(p) - 1)
  end function slave_weights

  !> Sum of the increases in the decay of the traction, over its largest value.
  function reversals(x, traction) result(ripple)
    real(rk), intent(in) :: x(:), traction(:)
    real(rk) :: ripple
    real(rk), allocatable :: size_of(:)
    logical, allocatable :: is_left(:)
    integer :: i, next
    size_of = abs(traction)
    allocate (is_left(size(x)), source=.true.)
    ripple = 0.0_rk
    i = minloc(x, 1)
    do
      is_left(i) = .false.
      if (.not. any(is_left)) exit
      next = minloc(x, 1, is_left)
      ripple = ripple + max(0.0_rk, size_of(next) - size_of(i))
      i = next
    end do
    ripple = ripple/maxval(size_of)
  end function reversals
end program test_joint_integration
