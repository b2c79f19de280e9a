!> What the laws of inelastic solids leave open within increments: sums over sampled points that
!> have a twin, whose increments are halved (theory.md, 14.7). It saves and loads itself; a new
!> component gets a line in both.
module path_errors
  use archive_type, only: archive
  use kinds, only: rk
  implicit none
  private
  public :: path_error, save_path, load_path

  !> Error over the difference of the twins: laws integrate with first order, so that two halves
  !> leave half of the error. Errors of points that cancel are not seen (verification.md).
  real(rk), parameter :: left_by_halves = 2.0_rk

  type :: path_error
    integer :: num_found = 0 !< points that have begun to dissipate
    integer :: num_points = 0 !< of these that have a twin
    real(rk) :: dissipated = 0.0_rk !< by the points with a twin [J]
    real(rk) :: difference = 0.0_rk !< largest sum of their differences to the twins so far [J]
    real(rk) :: stress = 0.0_rk !< largest difference of a stress so far [Pa]
  contains
    procedure :: relative
  end type path_error

contains

  !> The error of the dissipated energy over that energy.
  pure real(rk) function relative(self)
    class(path_error), intent(in) :: self
    relative = left_by_halves*self%difference/max(tiny(1.0_rk), self%dissipated)
  end function relative

  !> Writes the sums into the present group.
  subroutine save_path(path, file)
    type(path_error), intent(in) :: path
    class(archive), intent(inout) :: file
    call file%put('num_found', path%num_found)
    call file%put('num_points', path%num_points)
    call file%put('dissipated', path%dissipated)
    call file%put('difference', path%difference)
    call file%put('stress', path%stress)
  end subroutine save_path

  !> Reads the sums from the present group.
  subroutine load_path(path, file)
    type(path_error), intent(inout) :: path
    class(archive), intent(inout) :: file
    call file%get('num_found', path%num_found)
    call file%get('num_points', path%num_points)
    call file%get('dissipated', path%dissipated)
    call file%get('difference', path%difference)
    call file%get('stress', path%stress)
  end subroutine load_path
end module path_errors
