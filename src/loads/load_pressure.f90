!> *DLOAD P1..P6 and HP1..HP6, *DSLOAD P: pressure on faces of solids, uniform or hydrostatic.
module load_pressure
  use applied_load, only: load
  use dam_mesh, only: mesh, surface
  use kinds, only: rk
  use mesh_faces, only: face_nodes
  use shape_quad4, only: facet_point
  use wetted_facet, only: water_body, wet_facet, wet_the_facet
  implicit none
  private
  public :: pressure_load

  type, extends(load) :: pressure_load
    type(surface) :: faces !< where it acts
    real(rk) :: pressure = 0.0_rk !< positive pushes on the solid [Pa]; hydrostatic: at `reference`
    logical :: is_hydrostatic = .false. !< linear in z, zero at `top` and above
    real(rk) :: top = 0.0_rk, reference = 0.0_rk !< z [m]
  contains
    procedure :: add_force
  end type pressure_load

contains

  !> Minus the integral of N_a p n over each face.
  subroutine add_force(self, model, density, force)
    class(pressure_load), intent(in) :: self
    type(mesh), intent(in) :: model
    real(rk), intent(in) :: density(:)
    real(rk), intent(inout) :: force(:, :)
    real(rk) :: share(3, 4)
    integer :: i, a, nodes(4)
    do i = 1, size(self%faces%element)
      nodes = face_nodes(model, self%faces%element(i), self%faces%face(i))
      share = face_force(self, model%x(:, nodes))
      do a = 1, 4
        force(:, nodes(a)) = force(:, nodes(a)) + share(:, a)
      end do
    end do
  end subroutine add_force

  !> Forces on the corners of one face [N].
  pure function face_force(self, x) result(share)
    type(pressure_load), intent(in) :: self
    real(rk), intent(in) :: x(3, 4) !< [m]
    real(rk) :: share(3, 4)
    type(wet_facet) :: wet
    real(rk) :: n(4), area(3)
    integer :: q, a
    if (self%is_hydrostatic) then
      call wet_the_facet(x, water_body(level=self%top), wet)
      share = -self%pressure/(self%top - self%reference)*wet%head
      return
    end if
    share = 0.0_rk
    do q = 1, 4
      call facet_point(x, q, n, area)
      do a = 1, 4
        share(:, a) = share(:, a) - self%pressure*n(a)*area
      end do
    end do
  end function face_force
end module load_pressure
