!> The error of the time integration as modes show it (theory.md, 14.3-14.4): sums over increments.
!> It saves and loads itself; a new component gets a line in both.
module modal_errors
  use archive_type, only: archive
  use kinds, only: rk
  implicit none
  private
  public :: modal_error, save_timing, load_timing

  !> The motion of the modes as exact integration gives it, and the error of the run. Sums over the
  !> increments in which joints are open are weighted by the largest opening.
  type :: modal_error
    real(rk), allocatable :: exact(:), rate(:) !< (modes) displacement and velocity now
    real(rk), allocatable :: drive(:) !< (modes) force per mass now
    real(rk), allocatable :: carried(:), carried_rate(:) !< (modes) by moving supports
    real(rk), allocatable :: error(:) !< (modes) displacement of the run less the exact one
    real(rk) :: most = 0.0_rk !< largest norm of the errors so far
    real(rk) :: motion = 0.0_rk !< largest norm of the modal displacements so far
    real(rk) :: largest = 0.0_rk !< displacement so far [m]
    real(rk) :: at_largest = 0.0_rk !< its error [m]
    !> (modes) squared circular frequencies on the mesh less those of the structure [1/s2], and the
    !> motion with the latter; where the error of the mesh is estimated
    real(rk), allocatable :: stiffening(:), softer(:), softer_rate(:)
    real(rk) :: mesh_at_largest = 0.0_rk !< error of the mesh in the largest displacement [m]
    real(rk), allocatable :: mesh_at_most(:) !< (modes) when that of the opening was largest
    !> (modes, modes) sum of w w^T, w the displacements of an increment; with joints only
    real(rk), allocatable :: square(:, :)
    real(rk), allocatable :: product(:) !< (modes) sum of w times the increment of the opening
    real(rk) :: changes = 0.0_rk !< sum of the squares of the increments of the opening
    real(rk) :: opening = 0.0_rk !< largest so far [m]
    !> Sums over the modes and over the increments with open joints: squares of the forces that open
    !> joints have lost, over the circular frequencies; and of the displacements times these
    real(rk) :: lost = 0.0_rk, held = 0.0_rk
    real(rk), allocatable :: at_most(:) !< (modes) errors when that of the opening was largest
    integer :: num_broken = 0 !< points of joints that have lost their strength, at the start
    integer :: num_lost = 0 !< points that have lost it since then
  end type modal_error

contains

  !> Writes the errors into the present group.
  subroutine save_timing(timing, file)
    type(modal_error), intent(in) :: timing
    class(archive), intent(inout) :: file
    call file%put('exact', timing%exact)
    call file%put('rate', timing%rate)
    call file%put('drive', timing%drive)
    call file%put('carried', timing%carried)
    call file%put('carried_rate', timing%carried_rate)
    call file%put('error', timing%error)
    call file%put('most', timing%most)
    call file%put('motion', timing%motion)
    call file%put('largest', timing%largest)
    call file%put('at_largest', timing%at_largest)
    call file%put('stiffening', timing%stiffening)
    call file%put('softer', timing%softer)
    call file%put('softer_rate', timing%softer_rate)
    call file%put('mesh_at_largest', timing%mesh_at_largest)
    call file%put('mesh_at_most', timing%mesh_at_most)
    call file%put('square', timing%square)
    call file%put('product', timing%product)
    call file%put('changes', timing%changes)
    call file%put('at_most', timing%at_most)
    call file%put('opening', timing%opening)
    call file%put('lost', timing%lost)
    call file%put('held', timing%held)
    call file%put('num_broken', timing%num_broken)
    call file%put('num_lost', timing%num_lost)
  end subroutine save_timing

  !> Reads the errors from the present group.
  subroutine load_timing(timing, file)
    type(modal_error), intent(inout) :: timing
    class(archive), intent(inout) :: file
    call file%get('exact', timing%exact)
    call file%get('rate', timing%rate)
    call file%get('drive', timing%drive)
    call file%get('carried', timing%carried)
    call file%get('carried_rate', timing%carried_rate)
    call file%get('error', timing%error)
    call file%get('most', timing%most)
    call file%get('motion', timing%motion)
    call file%get('largest', timing%largest)
    call file%get('at_largest', timing%at_largest)
    call file%get('stiffening', timing%stiffening)
    call file%get('softer', timing%softer)
    call file%get('softer_rate', timing%softer_rate)
    call file%get('mesh_at_largest', timing%mesh_at_largest)
    call file%get('mesh_at_most', timing%mesh_at_most)
    call file%get('square', timing%square)
    call file%get('product', timing%product)
    call file%get('changes', timing%changes)
    call file%get('at_most', timing%at_most)
    call file%get('opening', timing%opening)
    call file%get('lost', timing%lost)
    call file%get('held', timing%held)
    call file%get('num_broken', timing%num_broken)
    call file%get('num_lost', timing%num_lost)
  end subroutine load_timing
end module modal_errors
