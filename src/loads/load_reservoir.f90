!> *RESERVOIR: hydrostatic pressure and added mass of the water on the wetted part of a surface.
!>
!> Added mass by Westergaard (paper_notes.md, 17): 7/8 rho sqrt(H y) per area, y the depth of the
!> point and H that of the reservoir; integrated with the shape functions over the wetted area, so
!> that the total over a vertical face of any mesh is 7/12 rho H**2 per metre. The mass acts along
!> the normal of the node, the mean of its wetted facets weighted by area: m n n^T, or only its
!> diagonal.
module load_reservoir
  use applied_load, only: load
  use dam_mesh, only: fe_mesh, surface, element_is_there
  use dof_numbering, only: numbering
  use guest_type, only: mass_matrix
  use kinds, only: rk
  use matrix_pattern, only: pattern
  use scatter_matrix, only: scatter_blocks
  use mesh_faces, only: face_nodes
  use row_tables, only: row_table
  use wetted_facet, only: water_body, wet_facet, integrate_wet_part
  implicit none
  private
  public :: reservoir_load, wetted_area

  real(rk), parameter :: westergaard = 7.0_rk/8.0_rk !< paper_notes.md, 17

  type, extends(load) :: reservoir_load
    type(surface) :: faces !< upstream face; its dry part is ignored
    integer, allocatable :: nodes(:, :) !< (4, faces) their nodes
    type(water_body) :: water
    real(rk) :: density = 1000.0_rk !< of water [kg/m3]
    real(rk) :: gravity = 9.81_rk !< [m/s2]
    logical :: is_hydrostatic = .true. !< has pressure
    logical :: has_added_mass = .false. !< Westergaard
    logical :: is_diagonal = .true. !< m n_k**2 on each axis, else m n n^T
  contains
    procedure :: take_faces
    procedure :: add_cells
    procedure :: add_force
    procedure :: has_matrix
    procedure :: add_matrix
    procedure :: add_added_mass
  end type reservoir_load

contains

  !> Sets the wetted surface.
  subroutine take_faces(self, faces, mesh)
    class(reservoir_load), intent(inout) :: self
    type(surface), intent(in) :: faces
    type(fe_mesh), intent(in) :: mesh
    integer :: i
    self%faces = faces
    allocate (self%nodes(4, size(faces%element)))
    do i = 1, size(faces%element)
      self%nodes(:, i) = face_nodes(mesh, faces%element(i), faces%face(i))
    end do
  end subroutine take_faces

  !> The nodes under the added mass, each by itself: the rank that adds the mass need not have the
  !> elements at them.
  subroutine add_cells(self, cells)
    class(reservoir_load), intent(in) :: self
    type(row_table), intent(inout) :: cells
    integer :: i, a
    if (.not. self%has_added_mass) return
    do i = 1, size(self%faces%element)
      do a = 1, size(self%nodes, 1)
        call cells%append(self%nodes(a:a, i))
      end do
    end do
  end subroutine add_cells

  !> Minus rho g times the integral of y N_a n.
  subroutine add_force(self, mesh, density, force)
    class(reservoir_load), intent(in) :: self
    type(fe_mesh), intent(in) :: mesh
    real(rk), intent(in) :: density(:)
    real(rk), intent(inout) :: force(:, :)
    type(wet_facet) :: wet
    integer :: i, a, nodes(4)
    if (.not. self%is_hydrostatic) return
    do i = 1, size(self%faces%element)
      if (.not. element_is_there(mesh, self%faces%element(i))) cycle
      nodes = face_nodes(mesh, self%faces%element(i), self%faces%face(i))
      call integrate_wet_part(mesh%x(:, nodes), self%water, wet, needs_root=.false.)
      do a = 1, 4
        force(:, nodes(a)) = force(:, nodes(a)) - self%density*self%gravity*wet%head(:, a)
      end do
    end do
  end subroutine add_force

  pure logical function has_matrix(self, kind)
    class(reservoir_load), intent(in) :: self
    integer, intent(in) :: kind
    has_matrix = self%has_added_mass .and. kind == mass_matrix
  end function has_matrix

  !> Adds the added mass of the water. The nodes are not coupled.
  subroutine add_matrix(self, kind, mesh, numbers, matrix, values)
    class(reservoir_load), intent(in) :: self
    integer, intent(in) :: kind
    type(fe_mesh), intent(in) :: mesh
    type(numbering), intent(in) :: numbers
    type(pattern), intent(in) :: matrix
    real(rk), intent(inout) :: values(:)
    real(rk), allocatable :: blocks(:, :, :)
    allocate (blocks(3, 3, mesh%num_nodes), source=0.0_rk)
    call self%add_added_mass(mesh, blocks)
    call scatter_blocks(numbers, blocks, matrix, values)
  end subroutine add_matrix

  !> Blocks m n n^T or their diagonal at the wetted nodes.
  subroutine add_added_mass(self, mesh, blocks)
    class(reservoir_load), intent(in) :: self
    type(fe_mesh), intent(in) :: mesh
    real(rk), intent(inout) :: blocks(:, :, :) !< (3, 3, nodes) [kg]
    real(rk), allocatable :: normal(:, :), mass(:)
    real(rk) :: n(3)
    integer :: node, i, j
    if (.not. self%has_added_mass) return
    call gather_water(self, mesh, normal, mass)
    do node = 1, mesh%num_nodes
      if (mass(node) <= 0.0_rk) cycle
      n = normal(:, node)/norm2(normal(:, node))
      do j = 1, 3
        do i = 1, 3
          if (self%is_diagonal .and. i /= j) cycle
          blocks(i, j, node) = blocks(i, j, node) + mass(node)*n(i)*n(j)
        end do
      end do
    end do
  end subroutine add_added_mass

  !> Area vector and mass of the water at each node.
  subroutine gather_water(self, mesh, normal, mass)
    class(reservoir_load), intent(in) :: self
    type(fe_mesh), intent(in) :: mesh
    real(rk), allocatable, intent(out) :: normal(:, :) !< (3, nodes) of any length
    real(rk), allocatable, intent(out) :: mass(:) !< (nodes) [kg]
    type(wet_facet) :: wet
    real(rk) :: factor
    integer :: i, a, nodes(4)
    allocate (normal(3, mesh%num_nodes), mass(mesh%num_nodes), source=0.0_rk)
    factor = westergaard*self%density*sqrt(self%water%level - self%water%bed)
    do i = 1, size(self%faces%element)
      if (.not. element_is_there(mesh, self%faces%element(i))) cycle
      nodes = face_nodes(mesh, self%faces%element(i), self%faces%face(i))
      call integrate_wet_part(mesh%x(:, nodes), self%water, wet)
      do a = 1, 4
        normal(:, nodes(a)) = normal(:, nodes(a)) + wet%area(:, a)
        mass(nodes(a)) = mass(nodes(a)) + factor*wet%root(a)
      end do
    end do
  end subroutine gather_water

  !> Area of the wetted part of the surface [m2]; 0 if the surface is dry.
  pure real(rk) function wetted_area(self, mesh) result(area)
    type(reservoir_load), intent(in) :: self
    type(fe_mesh), intent(in) :: mesh
    type(wet_facet) :: wet
    integer :: i, nodes(4)
    area = 0.0_rk
    do i = 1, size(self%faces%element)
      nodes = face_nodes(mesh, self%faces%element(i), self%faces%face(i))
      call integrate_wet_part(mesh%x(:, nodes), self%water, wet, needs_root=.false.)
      area = area + norm2(sum(wet%area, 2))
    end do
  end function wetted_area
end module load_reservoir
