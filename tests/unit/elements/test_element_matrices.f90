!> All solids: patch test, rigid motions, zero eigenvalues, wedges, volumes, bending, locking.
program test_element_matrices
  use element_catalogue, only: element_kinds, find_element_kind, is_solid, make_solid
  use element_formulation, only: solid_element, strains_of_element
  use element_matrices, only: consistent_masses, nodal_volumes, stiffness_matrices, &
                              stress_forces
  use hex8_slopes, only: slopes_at_points, strains_of_slopes
  use kinds, only: rk
  use material_elastic, only: elastic_law
  use shape_hex8, only: corner, corners_from_points
  use testing, only: check, check_close, test_log
  implicit none

  interface
    subroutine dsyev(jobz, uplo, n, a, lda, w, work, lwork, info)
      import :: rk
      implicit none
      character, intent(in) :: jobz, uplo
      integer, intent(in) :: n, lda, lwork
      real(rk), intent(inout) :: a(24, 24)
      real(rk), intent(out) :: w(24), work(200)
      integer, intent(out) :: info
    end subroutine dsyev
  end interface

  character(8), parameter :: solids(4) = ['C3D8    ', 'C3D8B   ', 'C3D8I   ', 'C3D8R   ']
  !> Node of each corner: a hexahedron, wedges collapsed on an edge of each direction.
  integer, parameter :: shapes(8, 4) = reshape([1, 2, 3, 4, 5, 6, 7, 8, 1, 2, 3, 3, 5, 6, 7, 7, &
                                                1, 2, 3, 4, 5, 5, 7, 7, 1, 2, 3, 4, 1, 2, 7, 8], &
                                               [8, 4])
  type(test_log) :: log
  integer :: i, j

  log%suite = 'element_matrices'
  do i = 1, 4
    do j = 1, 3
      call constant_strain_is_exact(trim(solids(i)), shapes(:, j), log)
      call six_motions_are_free(trim(solids(i)), shapes(:, j), log)
    end do
    call patch_of_seven(trim(solids(i)), log)
  end do
  do i = 1, 4
    call strains_without_operators(trim(solids(i)), log)
  end do
  call ways_to_the_plain_element(log)
  call bending_of_a_cube(log)
  call volume_locking(log)
  call volumes_and_masses(log)
  call bad_corners_are_named(log)
  call catalogue_is_consistent(log)
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> A distorted hexahedron; a wedge when nodes repeat.
  function distorted(nodes) result(x)
    integer, intent(in) :: nodes(8)
    real(rk) :: x(3, 8, 1)
    real(rk) :: place(3, 8)
    integer :: a
    place = corner
    do a = 1, 8
      place(:, a) = place(:, a) + 0.15_rk*[sin(3.0_rk*a), cos(5.0_rk*a), sin(7.0_rk*a + 1.0_rk)]
    end do
    x(:, :, 1) = place(:, nodes)
  end function distorted

  !> Hooke's matrix for E = 1.
  function hooke(poisson) result(d)
    real(rk), intent(in) :: poisson
    real(rk) :: d(6, 6)
    type(elastic_law) :: law
    law = elastic_law(young=1.0_rk, poisson=poisson)
    call law%elastic_stiffness(d)
  end function hooke

  !> Displacements of a linear field at points.
  function linear_field(x) result(u)
    real(rk), intent(in) :: x(:, :)
    real(rk) :: u(size(x))
    real(rk), parameter :: slope(3, 3) = reshape([1.0_rk, 0.3_rk, -0.2_rk, &
                                                  0.5_rk, -0.7_rk, 0.1_rk, &
                                                  0.4_rk, 0.9_rk, 0.6_rk], [3, 3])
    u = reshape(matmul(slope, x), [size(x)])
  end function linear_field

  !> The strains of two displacements are B u, in a hexahedron and in a wedge. Round-off of a few
  !> hundred products.
  subroutine strains_without_operators(name, log)
    character(*), intent(in) :: name
    type(test_log), intent(inout) :: log
    class(solid_element), allocatable :: element
    real(rk), allocatable :: b(:, :, :, :), weight(:, :), strain(:, :, :), expected(:, :, :)
    real(rk) :: x(3, 8, 1), u(24, 2)
    integer :: i, j, status(1)
    call make_solid(name, element)
    allocate (b(6, 24, element%num_points, 1), weight(element%num_points, 1))
    allocate (strain(6, element%num_points, 2), expected(6, element%num_points, 1))
    u = reshape([(sin(2.0_rk*i) + 0.1_rk*i, i=1, 48)], [24, 2])
    do j = 1, 2
      x = distorted(shapes(:, j))
      call element%strain_operator(x, hooke(0.2_rk), b, weight, status)
      call element%find_strains(x(:, :, 1), hooke(0.2_rk), u, strain)
      do i = 1, 2
        call strains_of_element(b(:, :, :, 1), u(:, i), expected(:, :, 1))
        call check(log, maxval(abs(strain(:, :, i) - expected(:, :, 1))) < &
                   1.0e-12_rk*maxval(abs(expected)), name//': strains without operators')
      end do
    end do
  end subroutine strains_without_operators

  !> A linear field gives its strain at all points, and K u = sum w B^T D eps.
  subroutine constant_strain_is_exact(name, nodes, log)
    character(*), intent(in) :: name
    integer, intent(in) :: nodes(8)
    type(test_log), intent(inout) :: log
    class(solid_element), allocatable :: element
    real(rk), allocatable :: b(:, :, :, :), weight(:, :), strain(:, :, :), stress(:, :, :)
    real(rk) :: x(3, 8, 1), u(24, 1), force(24, 1), ke(24, 24, 1), expected(6)
    integer :: status(1)
    call make_solid(name, element)
    x = distorted(nodes)
    u(:, 1) = linear_field(x(:, :, 1))
    allocate (b(6, 24, element%num_points, 1), weight(element%num_points, 1))
    allocate (strain(6, element%num_points, 1), stress(6, element%num_points, 1))
    call element%strain_operator(x, hooke(0.2_rk), b, weight, status)
    call strains_of_element(b(:, :, :, 1), u(:, 1), strain(:, :, 1))
    expected = [1.0_rk, -0.7_rk, 0.6_rk, 0.8_rk, 0.2_rk, 1.0_rk]
    call check(log, status(1) == 0, name//': sound')
    call check_close(log, maxval(abs(strain(:, :, 1) - spread(expected, 2, element%num_points))), &
                     0.0_rk, 1.0e-13_rk, name//': constant strain')
    stress(:, :, 1) = matmul(hooke(0.2_rk), strain(:, :, 1))
    call stress_forces(b, weight, stress, force)
    call stiffness_matrices(element, x, hooke(0.2_rk), ke, status)
    call check_close(log, maxval(abs(force(:, 1) - matmul(ke(:, :, 1), u(:, 1)))), 0.0_rk, &
                     1.0e-13_rk, name//': forces of the patch')
    call check_close(log, maxval(abs(ke(:, :, 1) - transpose(ke(:, :, 1)))), 0.0_rk, 0.0_rk, &
                     name//': symmetric')
  end subroutine constant_strain_is_exact

  !> Stiffness and strains of C3D8 from slopes equal those from the strain operator, with a
  !> stiffness that couples all strains; a cube with a wedge behind it.
  subroutine ways_to_the_plain_element(log)
    type(test_log), intent(inout) :: log
    class(solid_element), allocatable :: element
    real(rk) :: x(3, 8, 2), d(6, 6), fast(24, 24, 2), general(24, 24, 2), u(24, 2)
    real(rk) :: b(6, 24, 8, 2), weight(8, 2), strain(6, 8, 2)
    real(rk) :: slope(8, 3, 8), found(6, 8), volume(8)
    integer :: status(2), i, j, e
    do j = 1, 6
      do i = 1, 6
        d(i, j) = 0.1_rk*cos(real(i*j, rk)) + merge(2.0_rk + 0.1_rk*i, 0.0_rk, i == j)
      end do
    end do
    x(:, :, 1:1) = distorted(shapes(:, 1))
    x(:, :, 2:2) = distorted(shapes(:, 2))
    do e = 1, 2
      u(:, e) = [(sin(3.0_rk*i + e), i=1, 24)]
    end do
    call make_solid('C3D8', element)
    call check(log, element%has_plain_strain, 'C3D8 has the plain strain')
    call stiffness_matrices(element, x, d, fast, status)
    element%has_plain_strain = .false.
    call stiffness_matrices(element, x, d, general, status)
    call check_close(log, maxval(abs(fast - general)), 0.0_rk, 1.0e-14_rk*maxval(abs(general)), &
                     'stiffness from slopes')
    call element%strain_operator(x, d, b, weight, status)
    do e = 1, 2
      call strains_of_element(b(:, :, :, e), u(:, e), strain(:, :, e))
    end do
    do e = 1, 2
      call slopes_at_points(x(:, :, e), slope, volume, status(e))
      call strains_of_slopes(slope, u(:, e), found)
      call check_close(log, maxval(abs(found - strain(:, :, e))), 0.0_rk, &
                       1.0e-13_rk*maxval(abs(strain)), 'strains from slopes')
      call check_close(log, maxval(abs(volume - weight(:, e))), 0.0_rk, 0.0_rk, 'volumes')
    end do
  end subroutine ways_to_the_plain_element

  !> Six zero eigenvalues and no more, all others positive; repeated nodes are folded.
  subroutine six_motions_are_free(name, nodes, log)
    character(*), intent(in) :: name
    integer, intent(in) :: nodes(8)
    type(test_log), intent(inout) :: log
    class(solid_element), allocatable :: element
    real(rk) :: ke(24, 24, 1), fold(24, 24), folded(24, 24), eigenvalue(24), work(200)
    integer :: status(1), a, i, info, num_zero
    call make_solid(name, element)
    call stiffness_matrices(element, distorted(nodes), hooke(0.2_rk), ke, status)
    fold = 0.0_rk
    do a = 1, 8
      do i = 1, 3
        fold(3*a - 3 + i, 3*nodes(a) - 3 + i) = 1.0_rk
      end do
    end do
    folded = matmul(transpose(fold), matmul(ke(:, :, 1), fold))
    call dsyev('N', 'U', 24, folded, 24, eigenvalue, work, size(work), info)
    num_zero = 6 + 3*count([(all(nodes /= a), a=1, 8)])
    call check(log, info == 0, name//': eigenvalues found')
    call check_close(log, maxval(abs(eigenvalue(:num_zero))), 0.0_rk, 1.0e-13_rk, &
                     name//': rigid motions')
    call check(log, eigenvalue(num_zero + 1) > 1.0e-5_rk, name//': no other free motion')
  end subroutine six_motions_are_free

  !> Seven distorted elements in a cube (MacNeal & Harder): a linear field on the outside is found
  !> again at the inner nodes.
  subroutine patch_of_seven(name, log)
    character(*), intent(in) :: name
    type(test_log), intent(inout) :: log
    real(rk), parameter :: inner(3, 8) = reshape([0.249_rk, 0.342_rk, 0.192_rk, &
                                                  0.826_rk, 0.288_rk, 0.288_rk, &
                                                  0.850_rk, 0.649_rk, 0.263_rk, &
                                                  0.273_rk, 0.750_rk, 0.230_rk, &
                                                  0.320_rk, 0.186_rk, 0.643_rk, &
                                                  0.677_rk, 0.305_rk, 0.683_rk, &
                                                  0.788_rk, 0.693_rk, 0.644_rk, &
                                                  0.165_rk, 0.745_rk, 0.702_rk], [3, 8])
    integer, parameter :: cells(8, 7) = reshape([1, 2, 3, 4, 5, 6, 7, 8, &
                                                 9, 10, 11, 12, 1, 2, 3, 4, &
                                                 5, 6, 7, 8, 13, 14, 15, 16, &
                                                 9, 10, 2, 1, 13, 14, 6, 5, &
                                                 10, 11, 3, 2, 14, 15, 7, 6, &
                                                 11, 12, 4, 3, 15, 16, 8, 7, &
                                                 12, 9, 1, 4, 16, 13, 5, 8], [8, 7])
    class(solid_element), allocatable :: element
    real(rk) :: x(3, 16), cell(3, 8, 7), ke(24, 24, 7), k(48, 48), u(48), residual(24)
    integer :: status(7), dof(24), e, i
    x(:, :8) = inner
    x(:, 9:) = 0.5_rk + 0.5_rk*corner
    do e = 1, 7
      cell(:, :, e) = x(:, cells(:, e))
    end do
    call make_solid(name, element)
    call stiffness_matrices(element, cell, hooke(0.25_rk), ke, status)
    call check(log, all(status == 0), name//': patch is sound')
    k = 0.0_rk
    do e = 1, 7
      do i = 1, 3
        dof(i::3) = 3*cells(:, e) - 3 + i
      end do
      k(dof, dof) = k(dof, dof) + ke(:, :, e)
    end do
    u = linear_field(x)
    residual = matmul(k(:24, :), u)
    call check_close(log, maxval(abs(residual)), 0.0_rk, 1.0e-13_rk, name//': patch of seven')
  end subroutine patch_of_seven

  !> Energy of pure bending of a cube with free sides is M**2/(2 E I); only incompatible modes have
  !> it, the full element is too stiff.
  subroutine bending_of_a_cube(log)
    type(test_log), intent(inout) :: log
    class(solid_element), allocatable :: element
    real(rk) :: x(3, 8, 1), ke(24, 24, 1), u(24), energy(2)
    integer :: status(1), i
    x(:, :, 1) = 0.5_rk*corner
    u = 0.0_rk
    u(1::3) = x(1, :, 1)*x(3, :, 1)
    do i = 1, 2
      call make_solid(trim(solids(2*i - 1)), element)
      call stiffness_matrices(element, x, hooke(0.0_rk), ke, status)
      energy(i) = 0.5_rk*dot_product(u, matmul(ke(:, :, 1), u))
    end do
    call check_close(log, energy(2), 1.0_rk/24.0_rk, 1.0e-14_rk, 'C3D8I bends as a beam')
    call check_close(log, energy(1), 1.5_rk/24.0_rk, 1.0e-14_rk, 'C3D8 adds its parasitic shear')
  end subroutine bending_of_a_cube

  !> A bending mode of a nearly incompressible cube: the full element locks, B-bar does not.
  subroutine volume_locking(log)
    type(test_log), intent(inout) :: log
    class(solid_element), allocatable :: element
    real(rk) :: x(3, 8, 1), ke(24, 24, 1), u(24), energy(2)
    integer :: status(1), i
    x(:, :, 1) = 0.5_rk*corner
    u = 0.0_rk
    u(1::3) = x(1, :, 1)*x(3, :, 1)
    do i = 1, 2
      call make_solid(trim(solids(i)), element)
      call stiffness_matrices(element, x, hooke(0.4999_rk), ke, status)
      energy(i) = 0.5_rk*dot_product(u, matmul(ke(:, :, 1), u))
    end do
    call check(log, energy(1) > 50.0_rk, 'C3D8 locks')
    call check(log, energy(2) < 0.1_rk, 'C3D8B does not')
  end subroutine volume_locking

  !> Total volume and mass; the wedge has half the box's.
  subroutine volumes_and_masses(log)
    type(test_log), intent(inout) :: log
    real(rk) :: x(3, 8, 2), volume(8, 2), mass(8, 8, 2)
    x(:, :, 1) = corner
    x(:, :, 2) = corner(:, [1, 2, 3, 3, 5, 6, 7, 7])
    call nodal_volumes(x, volume)
    call consistent_masses(x, 2400.0_rk, mass)
    call check_close(log, sum(volume(:, 1)), 8.0_rk, 1.0e-13_rk, 'volume of a cube')
    call check_close(log, sum(volume(:, 2)), 4.0_rk, 1.0e-13_rk, 'volume of a wedge')
    call check_close(log, volume(1, 2), 4.0_rk/6.0_rk, 1.0e-13_rk, 'a corner of the wedge')
    call check_close(log, sum(mass(:, :, 1)), 19200.0_rk, 1.0e-9_rk, 'mass of a cube')
    call check_close(log, mass(1, 1, 1), 19200.0_rk/27.0_rk, 1.0e-9_rk, 'consistent diagonal')
    call check(log, all(volume > 0.0_rk), 'lumped masses are positive')
    call check_close(log, maxval(abs(sum(corners_from_points(), 2) - 1.0_rk)), 0.0_rk, &
                     1.0e-14_rk, 'extrapolation keeps constants')
  end subroutine volumes_and_masses

  !> Inside-out and flat corners are reported by their number.
  subroutine bad_corners_are_named(log)
    type(test_log), intent(inout) :: log
    class(solid_element), allocatable :: element
    real(rk) :: x(3, 8, 3), ke(24, 24, 3)
    integer :: status(3)
    x(:, :, 1) = corner
    x(:, :, 2) = corner
    x(:, 7, 2) = -0.9_rk
    x(:, :, 3) = corner(:, [5, 6, 7, 8, 1, 2, 3, 4])
    call make_solid('C3D8', element)
    call stiffness_matrices(element, x, hooke(0.2_rk), ke, status)
    call check(log, status(1) == 0, 'a cube is sound')
    call check(log, status(2) == 7, 'a cube with corner 7 pushed through is not')
    call check(log, status(3) == 1, 'an inside-out cube fails at its first corner')
  end subroutine bad_corners_are_named

  !> Every solid of the list has a maker.
  subroutine catalogue_is_consistent(log)
    type(test_log), intent(inout) :: log
    class(solid_element), allocatable :: element
    integer :: row
    do row = 1, size(element_kinds)
      call make_solid(trim(element_kinds(row)%name), element)
      call check(log, allocated(element) .eqv. element_kinds(row)%is_solid, element_kinds(row)%name)
    end do
    call check(log, find_element_kind('C3D20') == 0, 'no C3D20')
    call check(log, is_solid('C3D8R') .and. .not. is_solid('JOINT8'), 'solids')
  end subroutine catalogue_is_consistent
end program test_element_matrices
