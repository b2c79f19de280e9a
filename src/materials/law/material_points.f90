!> Points of a material: their place, their state and their time increment.
module material_points
  use archive_type, only: archive
  use guest_history, only: history
  use kinds, only: rk
  implicit none
  private
  public :: point_set, point_state, time_increment, update_report, make_room
  public :: no_tangent, secant_tangent, consistent_tangent
  public :: stored_energy, fracture_energy, crushing_energy, created_energy, num_energies

  !> The tangents that an update can return.
  integer, parameter :: no_tangent = 0
  integer, parameter :: secant_tangent = 1 !< symmetric, positive definite
  integer, parameter :: consistent_tangent = 2 !< derivative of the stress, may be unsymmetric

  !> Rows of `point_state%energy`.
  integer, parameter :: stored_energy = 1 !< recovered by unloading
  integer, parameter :: fracture_energy = 2 !< dissipated so far, by cracking or by metal plasticity
  integer, parameter :: crushing_energy = 3 !< dissipated so far, in compression
  integer, parameter :: created_energy = 4 !< so far, by a law without potential; may be < 0
  integer, parameter :: num_energies = 4

  !> The points of a block: constant during the analysis.
  type :: point_set
    integer :: num_points = 0
    integer, allocatable :: element(:) !< (points) the user's number of the element
    integer, allocatable :: number(:) !< (points) of the integration point in its element, 1..8
    real(rk), allocatable :: x(:, :) !< (3, points) place [m]
    !> (3, 3, points) columns are the edge vectors of the element at the point, 2 dx/dxi_i [m].
    !> Their projections on the normal of a crack give the width of the crack band.
    real(rk), allocatable :: edges(:, :, :)
    real(rk), allocatable :: widest(:) !< (points) width of the widest crack band [m]
    real(rk), allocatable :: length(:) !< (points) cube root of the element's volume [m]
  end type point_set

  !> The state of the points of a block, converged or trial. A new component gets a line in save and
  !> load.
  type, extends(history) :: point_state
    !> (6, points) 11 22 33 12 13 23, engineering shear; without the thermal strain
    real(rk), allocatable :: strain(:, :)
    real(rk), allocatable :: stress(:, :) !< (6, points) [Pa]
    real(rk), allocatable :: internal(:, :) !< (law%num_state, points)
    real(rk), allocatable :: energy(:, :) !< (num_energies, points) [J/m3]
    !> (3, 3, points) du_i/dx_j; size 0 unless law%wants_gradient.
    real(rk), allocatable :: gradient(:, :, :)
    !> (points) the stress is D strain and the tangent is D, the undamaged stiffness.
    logical, allocatable :: is_elastic(:)
    !> (points) temperature; in models with *TEMPERATURE only [K]
    real(rk), allocatable :: temperature(:)
    !> (6, points) thermal strain, which `strain` does not hold; where the material expands
    real(rk), allocatable :: thermal(:, :)
  contains
    procedure :: is_elsewhere
    procedure :: save => save_points
    procedure :: load => load_points
  end type point_state

  !> The time increment of an update.
  type :: time_increment
    integer :: step = 1
    integer :: increment = 1 !< within the step
    real(rk) :: step_time = 0.0_rk, total_time = 0.0_rk !< at its start [s]
    real(rk) :: size = 1.0_rk !< [s]
    integer :: tangent = consistent_tangent !< to return
    !> True: switches that make the stress discontinuous keep their value from the start of the
    !> increment.
    logical :: holds_switches = .false.
    !> False: laws that defer their energies leave them out.
    logical :: wants_energy = .true.
    !> True: stress and history at the end are those of an update of the same increment without
    !> energies, which a law may keep and complete.
    logical :: is_updated = .false.
    !> (points) Strain and history at the start are those of the last update, whose answer a law may
    !> keep; not allocated: none
    logical, allocatable :: stays(:)
  end type time_increment

  !> What went wrong in an update.
  type :: update_report
    integer :: failed_point = 0 !< position in the block, 0 for none: the increment must be cut
    character(:), allocatable :: message !< why
    real(rk) :: size_ratio = 1.0_rk !< below 1: size that the law requests, over the present size
  end type update_report

contains

  !> Tables of `n` points, without values.
  pure subroutine make_room(points, n)
    type(point_set), intent(out) :: points
    integer, intent(in) :: n
    points%num_points = n
    allocate (points%element(n), points%number(n), points%x(3, n), points%edges(3, 3, n), &
              points%widest(n), points%length(n))
  end subroutine make_room

  !> Whether another rank alone has the points of the block: a block has one at least.
  pure logical function is_elsewhere(self)
    class(point_state), intent(in) :: self
    is_elsewhere = .false.
    if (allocated(self%is_elastic)) is_elsewhere = size(self%is_elastic) == 0
  end function is_elsewhere

  !> Writes the points of one block into the present group.
  subroutine save_points(self, file)
    class(point_state), intent(in) :: self
    class(archive), intent(inout) :: file
    call file%put('strain', self%strain)
    call file%put('stress', self%stress)
    call file%put('internal', self%internal)
    call file%put('energy', self%energy)
    call file%put('gradient', self%gradient)
    call file%put('is_elastic', self%is_elastic)
    call file%put('temperature', self%temperature)
    call file%put('thermal', self%thermal)
  end subroutine save_points

  !> Reads the points of one block from the present group. The points must be in their initial
  !> state, which fixes the sizes.
  subroutine load_points(self, file)
    class(point_state), intent(inout) :: self
    class(archive), intent(inout) :: file
    call file%get('strain', self%strain)
    call file%get('stress', self%stress)
    call file%get('internal', self%internal)
    call file%get('energy', self%energy)
    call file%get('gradient', self%gradient)
    call file%get('is_elastic', self%is_elastic)
    if (.not. allocated(self%is_elastic)) return
    call file%get('temperature', self%temperature, shape(self%is_elastic))
    call file%get('thermal', self%thermal, [6, size(self%is_elastic)])
  end subroutine load_points
end module material_points
