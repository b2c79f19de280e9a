!> *JOINT LAW, UPLIFT: the pressure of a reservoir's water in a joint. It pushes both faces apart.
!>
!> Source: different_meshes.md, 13.6. LINEAR: the head of the reservoir at each point times
!> the share s = b/(a + b), a and b its distances to the upstream and the downstream edge, in open
!> and closed joints; a reservoir downstream gives 1 - s of its head. OPEN: the full head at points
!> that open points connect with the upstream edge; the solver determines these points.
module load_uplift
  use applied_load, only: load
  use dam_mesh, only: fe_mesh
  use joint_parts, only: point_is_there
  use joint_points, only: dam_joint
  use joint_rim, only: distance_to_edges, face_rim
  use kinds, only: rk
  use load_reservoir, only: reservoir_load
  use water_paths, only: build_paths, find_wet, path_net
  implicit none
  private
  public :: uplift_load, fill_dry, fill_linear, fill_open

  type, extends(load) :: uplift_load
    real(rk), allocatable :: pressure(:) !< (points) at factor 1, where there is water [Pa]
    integer, allocatable :: node(:) !< of the forces of a constant profile
    real(rk), allocatable :: force(:, :) !< (3, nodes) [N]
    type(path_net) :: paths !< of the water, profile OPEN
  contains
    procedure :: add_force
    procedure :: joint_pressure
    procedure :: follow_joint
  end type uplift_load

contains

  !> Hydrostatic pressure of a reservoir at the points of a joint [Pa].
  pure function hydrostatic_pressure(lake, joint) result(pressure)
    type(reservoir_load), intent(in) :: lake
    type(dam_joint), intent(in) :: joint
    real(rk) :: pressure(joint%num_points)
    pressure = 0.0_rk
    if (lake%is_hydrostatic) then
      pressure = lake%density*lake%gravity*max(0.0_rk, lake%water%level - joint%x(lake%water%up, :))
    end if
  end function hydrostatic_pressure

  !> No pressure.
  subroutine fill_dry(mesh, joint, self)
    type(fe_mesh), intent(in) :: mesh
    type(dam_joint), intent(in) :: joint
    type(uplift_load), intent(inout) :: self
    allocate (self%pressure(joint%num_points), source=0.0_rk)
    call self%follow_joint(mesh, joint)
  end subroutine fill_dry

  !> The classical diagram: full head at one edge, falling to zero at the other.
  subroutine fill_linear(mesh, joint, rim, lake, is_tail, self)
    type(fe_mesh), intent(in) :: mesh
    type(dam_joint), intent(in) :: joint
    type(face_rim), intent(in) :: rim
    type(reservoir_load), intent(in) :: lake
    logical, intent(in) :: is_tail !< the water stands at the downstream edge
    type(uplift_load), intent(inout) :: self
    real(rk) :: a, b
    integer :: p
    self%pressure = hydrostatic_pressure(lake, joint)
    do p = 1, joint%num_points
      a = distance_to_edges(mesh%x, rim%upstream, joint%x(:, p))
      b = distance_to_edges(mesh%x, rim%downstream, joint%x(:, p))
      if (is_tail) then
        self%pressure(p) = self%pressure(p)*a/(a + b)
      else
        self%pressure(p) = self%pressure(p)*b/(a + b)
      end if
    end do
    call self%follow_joint(mesh, joint)
  end subroutine fill_linear

  !> Full head, and the paths of the water.
  subroutine fill_open(mesh, joint, rim, facets, lake, self)
    type(fe_mesh), intent(in) :: mesh
    type(dam_joint), intent(in) :: joint
    type(face_rim), intent(in) :: rim
    integer, intent(in) :: facets(:, :) !< (4, facets) of the slave face
    type(reservoir_load), intent(in) :: lake
    type(uplift_load), intent(inout) :: self
    real(rk), allocatable :: distance(:)
    integer :: p
    self%follows_opening = .true.
    self%pressure = hydrostatic_pressure(lake, joint)
    allocate (distance(joint%num_points), self%node(0), self%force(3, 0))
    do p = 1, joint%num_points
      distance(p) = distance_to_edges(mesh%x, rim%upstream, joint%x(:, p))
    end do
    call build_paths(mesh%num_nodes, joint, facets, distance, self%paths)
  end subroutine fill_open

  !> Forces area*pressure along the normal on the slave face, and opposite on the master face, at
  !> the points that are there.
  subroutine follow_joint(self, mesh, joint)
    class(uplift_load), intent(inout) :: self
    type(fe_mesh), intent(in) :: mesh
    type(dam_joint), intent(in) :: joint
    integer :: p, k
    if (self%follows_opening) return
    self%node = joint%node
    if (allocated(self%force)) deallocate (self%force)
    allocate (self%force(3, size(joint%node)), source=0.0_rk)
    do p = 1, joint%num_points
      if (.not. point_is_there(mesh, joint, p)) cycle
      do k = joint%first(p), joint%first(p + 1) - 1
        self%force(:, k) = joint%weight(k)*joint%area(p)*self%pressure(p)*joint%rotation(1, :, p)
      end do
    end do
  end subroutine follow_joint

  !> Adds the forces of a constant profile; does nothing for profile OPEN.
  subroutine add_force(self, mesh, density, force)
    class(uplift_load), intent(in) :: self
    type(fe_mesh), intent(in) :: mesh
    real(rk), intent(in) :: density(:)
    real(rk), intent(inout) :: force(:, :)
    integer :: k
    do k = 1, size(self%node)
      force(:, self%node(k)) = force(:, self%node(k)) + self%force(:, k)
    end do
  end subroutine add_force

  !> The constant profile, or the full head at points that open points connect to the upstream
  !> edge.
  pure subroutine joint_pressure(self, is_open, pressure)
    class(uplift_load), intent(in) :: self
    logical, intent(in) :: is_open(:)
    real(rk), intent(out) :: pressure(:)
    logical :: is_wet(size(is_open))
    pressure = self%pressure
    if (.not. self%follows_opening) return
    call find_wet(self%paths, is_open, is_wet)
    pressure = merge(self%pressure, 0.0_rk, is_wet)
  end subroutine joint_pressure
end module load_uplift
