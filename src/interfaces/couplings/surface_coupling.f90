!> Springs between two faces of different meshes: Eqs. 1-8 on the segments of the faces.
!>
!> At a point of a segment the faces differ by delta u = N u (Eqs. 1-5: N_s of the slave facet's
!> four nodes, -N_m of the master facet's). Springs of `stiffness` per area resist it in x, y and z
!> alike (Eq. 6), which gives each segment the matrix (Eq. 8; different_meshes.md, 13.4)
!>   K = k int N^T N dA.
module surface_coupling
  use facet_segments, only: find_segments
  use dam_mesh, only: fe_mesh, are_there
  use dof_numbering, only: numbering
  use guest_type, only: guest, stiffness_matrix
  use kinds, only: rk
  use matrix_pattern, only: pattern
  use node_dofs, only: num_directions
  use row_tables, only: row_table
  use scatter_matrix, only: scatter_nodes
  use write_text, only: as_text
  use segment_quadrature, only: integrate_segment, segment_points
  use surface_segments, only: facet_set, segment_set, surface_cover
  implicit none
  private
  public :: coupling, build_coupling

  integer, parameter :: num_nodes = 8 !< of two facets
  integer, parameter :: num_dofs = num_directions*num_nodes

  type, extends(guest) :: coupling
    character(:), allocatable :: keyword !< 'INTERFACE' or 'TIE'
    real(rk) :: stiffness = 0.0_rk !< k_x = k_y = k_z [Pa/m]
    integer, allocatable :: node(:, :) !< (8, segments) of the slave facet, then the master facet
    real(rk), allocatable :: product(:, :, :) !< (8, 8, segments) int N^T N dA [m2]
  contains
    procedure :: add_cells
    procedure :: has_matrix
    procedure :: add_matrix
    procedure :: describe
  end type coupling

contains

  !> Finds the segments of two faces and integrates over them.
  pure subroutine build_coupling(x, slave, master, stiffness, name, keyword, built, cover)
    real(rk), intent(in) :: x(:, :) !< (3, nodes) [m]
    type(facet_set), intent(in) :: slave, master
    real(rk), intent(in) :: stiffness !< [Pa/m]
    character(*), intent(in) :: name !< upper case
    character(*), intent(in) :: keyword !< 'INTERFACE' or 'TIE'
    type(coupling), intent(out) :: built
    type(surface_cover), intent(out) :: cover
    type(segment_set) :: segments
    type(segment_points) :: points
    integer :: s
    built%name = name
    built%kind = 'coupling'
    built%keyword = keyword
    built%stiffness = stiffness
    call find_segments(x, slave, master, segments, cover)
    allocate (built%node(8, segments%num_segments), built%product(8, 8, segments%num_segments))
    do s = 1, segments%num_segments
      built%node(1:4, s) = slave%node(:, segments%slave(s))
      built%node(5:8, s) = master%node(:, segments%master(s))
      call integrate_segment(x, slave, master, segments, s, points)
      call sum_products(points, built%product(:, :, s))
    end do
  end subroutine build_coupling

  !> The nodes of each segment.
  subroutine add_cells(self, cells)
    class(coupling), intent(in) :: self
    type(row_table), intent(inout) :: cells
    integer :: s
    do s = 1, size(self%node, 2)
      call cells%append(self%node(:, s))
    end do
  end subroutine add_cells

  pure logical function has_matrix(self, kind)
    class(coupling), intent(in) :: self
    integer, intent(in) :: kind
    has_matrix = kind == stiffness_matrix
  end function has_matrix

  !> K = K + k int N^T N dA, segment by segment, equal in the three directions.
  subroutine add_matrix(self, kind, mesh, numbers, matrix, values)
    class(coupling), intent(in) :: self
    integer, intent(in) :: kind
    type(fe_mesh), intent(in) :: mesh
    type(numbering), intent(in) :: numbers
    type(pattern), intent(in) :: matrix
    real(rk), intent(inout) :: values(:)
    real(rk) :: k(num_dofs, num_dofs)
    integer :: s, i
    k = 0.0_rk
    do s = 1, size(self%node, 2)
      if (.not. are_there(mesh, self%node(:, s))) cycle
      do i = 1, num_directions
        k(i::num_directions, i::num_directions) = self%stiffness*self%product(:, :, s)
      end do
      call scatter_nodes(numbers, self%node(:, s), k, matrix, values)
    end do
  end subroutine add_matrix

  !> The springs in the summary of the model.
  function describe(self) result(text)
    class(coupling), intent(in) :: self
    character(:), allocatable :: text
    text = self%keyword//' of springs, '//as_text(size(self%node, 2))//' segments, STIFFNESS '// &
           as_text(self%stiffness)//' Pa/m'
  end function describe

  !> int N^T N dA of a segment.
  pure subroutine sum_products(points, product)
    type(segment_points), intent(in) :: points
    real(rk), intent(out) :: product(8, 8) !< [m2]
    real(rk) :: n(8)
    integer :: q, j
    product = 0.0_rk
    do q = 1, points%num_points
      n = [points%slave_shape(:, q), -points%master_shape(:, q)]
      do j = 1, 8
        product(:, j) = product(:, j) + points%area(q)*n(j)*n
      end do
    end do
  end subroutine sum_products
end module surface_coupling
