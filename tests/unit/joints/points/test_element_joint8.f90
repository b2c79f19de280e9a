!> Points of joints: areas, orientation, merging, triangles, ends in rock, bad pairs.
program test_element_joint8
  use dam_mesh, only: fe_mesh
  use element_joint8, only: build_joint_points, find_attached_solids
  use errors, only: error_type
  use joint_points, only: dam_joint
  use kinds, only: rk
  use testing, only: check, check_close, test_log
  implicit none
  type(test_log) :: log

  log%suite = 'element_joint8'
  call two_facets_share_pairs(log)
  call solids_orient_the_normal(log)
  call gauss_points_carry_the_area(log)
  call planes_stay_apart(log)
  call triangle_and_rock(log)
  call bad_pairs_are_named(log)
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Two blocks, cubes over 0 < z < 1 left and right of the plane x = 0, each of two cubes along y;
  !> nodes 1-12 left, 13-24 right; elements 1-2 left, 3-4 right, 5-6 JOINT8 with master left.
  subroutine two_blocks(mesh)
    type(fe_mesh), intent(out) :: mesh
    integer :: i, j, k, e, side, n
    mesh%num_nodes = 24
    mesh%num_elements = 6
    allocate (mesh%x(3, 24), mesh%nodes(8, 6), mesh%element_type(6))
    do side = 0, 1
      n = 12*side
      do i = 0, 1
        do j = 0, 2
          do k = 0, 1
            mesh%x(:, n + 1 + i + 2*j + 6*k) = real([i + side - 1, j, k], rk)
          end do
        end do
      end do
      do e = 1, 2
        mesh%nodes(:, 2*side + e) = n + 2*(e - 1) + [1, 2, 4, 3, 7, 8, 10, 9]
      end do
    end do
    do e = 1, 2
      mesh%nodes(:4, 4 + e) = mesh%nodes([2, 3, 7, 6], e)
      mesh%nodes(5:, 4 + e) = mesh%nodes([1, 4, 8, 5], 2 + e)
    end do
    mesh%element_type = 'C3D8'
    mesh%element_type(5:) = 'JOINT8'
    mesh%node_id = [(100 + n, n=1, 24)]
    mesh%element_id = [(e, e=1, 6)]
  end subroutine two_blocks

  subroutine two_facets_share_pairs(log)
    type(test_log), intent(inout) :: log
    type(fe_mesh) :: mesh
    type(dam_joint) :: built
    type(error_type), allocatable :: error
    integer :: p
    call two_blocks(mesh)
    call build_joint_points(mesh, [5, 6], .true., built, error)
    call check(log, (.not. allocated(error)), 'built')
    call check(log, built%num_points == 6, 'six pairs')
    call check_close(log, sum(built%area), 2.0_rk, 1.0e-14_rk, 'whole area')
    call check_close(log, maxval(built%area), 0.5_rk, 1.0e-14_rk, 'two shares in the middle')
    do p = 1, 6
      call check_close(log, norm2(built%rotation(1, :, p) - [1.0_rk, 0.0_rk, 0.0_rk]), 0.0_rk, &
                       1.0e-14_rk, 'normal along x')
      call check_close(log, norm2(built%rotation(2, :, p) - [0.0_rk, 1.0_rk, 0.0_rk]), 0.0_rk, &
                       1.0e-14_rk, 'slip 1 is horizontal')
      call check_close(log, norm2(built%rotation(3, :, p) - [0.0_rk, 0.0_rk, 1.0_rk]), 0.0_rk, &
                       1.0e-14_rk, 'slip 2 is upwards')
    end do
  end subroutine two_facets_share_pairs

  !> Nodes numbered the other way round, one side without solid, none, contradiction.
  subroutine solids_orient_the_normal(log)
    type(test_log), intent(inout) :: log
    type(fe_mesh) :: mesh
    type(dam_joint) :: built
    type(error_type), allocatable :: error
    integer, allocatable :: solid(:, :)
    integer :: side(1)
    call two_blocks(mesh)
    mesh%nodes(:, 5) = mesh%nodes([4, 3, 2, 1, 8, 7, 6, 5], 5)
    call build_joint_points(mesh, [5], .true., built, error)
    call check_close(log, built%rotation(1, 1, 1), 1.0_rk, 1.0e-14_rk, 'reversed numbering')
    call find_attached_solids(mesh, [5], solid, side)
    call check(log, all(solid(:, 1) == [1, 3]), 'solids behind both faces')
    call check(log, side(1) == -1, 'against the numbering')
    mesh%element_type([1, 2]) = 'NONE'
    call build_joint_points(mesh, [5], .true., built, error)
    call check_close(log, built%rotation(1, 1, 1), 1.0_rk, 1.0e-14_rk, 'slave solid only')
    mesh%element_type([3, 4]) = 'NONE'
    call build_joint_points(mesh, [5], .true., built, error)
    call check_close(log, built%rotation(1, 1, 1), -1.0_rk, 1.0e-14_rk, 'right-hand rule')
    call two_blocks(mesh)
    mesh%x(1, 13:) = -mesh%x(1, 13:)
    mesh%nodes(:, 3:4) = mesh%nodes([2, 1, 4, 3, 6, 5, 8, 7], 3:4)
    call build_joint_points(mesh, [5], .true., built, error)
    call check(log, allocated(error), 'both solids on one side')
  end subroutine solids_orient_the_normal

  subroutine gauss_points_carry_the_area(log)
    type(test_log), intent(inout) :: log
    type(fe_mesh) :: mesh
    type(dam_joint) :: built
    type(error_type), allocatable :: error
    call two_blocks(mesh)
    call build_joint_points(mesh, [5, 6], .false., built, error)
    call check(log, built%num_points == 8, 'four points a facet')
    call check_close(log, sum(built%area), 2.0_rk, 1.0e-14_rk, 'whole area')
    call check_close(log, sum(abs(built%weight)), 16.0_rk, 1.0e-14_rk, &
                     'shape functions add up to 1')
    call check_close(log, sum(built%x(2, :)*built%area), 2.0_rk, 1.0e-14_rk, 'first moment')
  end subroutine gauss_points_carry_the_area

  !> A joint with a right-angled bend has two points on the edge, each with its own normal.
  subroutine planes_stay_apart(log)
    type(test_log), intent(inout) :: log
    type(fe_mesh) :: mesh
    type(dam_joint) :: built
    type(error_type), allocatable :: error
    integer :: n
    mesh%num_nodes = 12
    mesh%num_elements = 2
    mesh%x = real(reshape([0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 1, 0, 1, 1, 1, 1, &
                           0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 1, 0, 1, 1, 1, 1], [3, 12]), rk)
    mesh%nodes = reshape([1, 2, 4, 3, 7, 8, 10, 9, 3, 4, 6, 5, 9, 10, 12, 11], [8, 2])
    mesh%element_type = ['JOINT8  ', 'JOINT8  ']
    mesh%node_id = [(n, n=1, 12)]
    mesh%element_id = [1, 2]
    call build_joint_points(mesh, [1, 2], .true., built, error)
    call check(log, built%num_points == 8, 'two points on each pair of the edge')
    call check_close(log, sum(built%area), 2.0_rk, 1.0e-14_rk, 'whole area')
    mesh%x(3, [5, 6, 11, 12]) = 6.0_rk
    call build_joint_points(mesh, [1, 2], .true., built, error)
    call check(log, built%num_points == 6, 'a bend below 30 degrees has one')
  end subroutine planes_stay_apart

  !> A triangle (repeated nodes) whose foot pair is one node in the rock.
  subroutine triangle_and_rock(log)
    type(test_log), intent(inout) :: log
    type(fe_mesh) :: mesh
    type(dam_joint) :: built
    type(error_type), allocatable :: error
    integer :: n
    mesh%num_nodes = 5
    mesh%num_elements = 1
    mesh%x = real(reshape([0, 0, 0, 2, 0, 1, 0, 0, 1, 2, 0, 1, 0, 0, 1], [3, 5]), rk)
    mesh%nodes = reshape([1, 2, 3, 3, 1, 4, 5, 5], [8, 1])
    mesh%element_type = ['JOINT8  ']
    mesh%node_id = [(n, n=1, 5)]
    mesh%element_id = [1]
    call build_joint_points(mesh, [1], .true., built, error)
    call check(log, built%num_points == 2, 'no point where master and slave are one node')
    call check_close(log, built%area(1), 1.0_rk/3.0_rk, 1.0e-14_rk, 'a third of the triangle')
    call check_close(log, built%area(2), 1.0_rk/3.0_rk, 1.0e-14_rk, 'also at the repeated node')
  end subroutine triangle_and_rock

  subroutine bad_pairs_are_named(log)
    type(test_log), intent(inout) :: log
    type(fe_mesh) :: mesh
    type(dam_joint) :: built
    type(error_type), allocatable :: error
    call two_blocks(mesh)
    mesh%x(3, 13) = 0.25_rk
    call build_joint_points(mesh, [5, 6], .true., built, error)
    call check(log, allocated(error), 'nodes of a pair do not coincide')
    call check(log, index(error%message, 'nodes 102 and 113 lie 2.500E-01 apart') > 0, &
               error%message)
  end subroutine bad_pairs_are_named
end program test_element_joint8
