!> *DLOAD P1..P6 and HP1..HP6, *DSLOAD P: pressure on faces of solids, uniform or hydrostatic.
module load_pressure
  use applied_load, only: load
  use dam_mesh, only: fe_mesh, surface, element_is_there
  use kinds, only: rk
  use mesh_faces, only: face_nodes
  use shape_quad4, only: facet_point
  use wetted_facet, only: water_body, wet_facet, integrate_wet_part
  implicit none
  private
  public :: pressure_load, face_of_word, faces_of_elements

  type, extends(load) :: pressure_load
    type(surface) :: faces !< loaded faces
    real(rk) :: pressure = 0.0_rk !< positive pushes on the solid [Pa]; hydrostatic: at `reference`
    logical :: is_hydrostatic = .false. !< linear in z, zero at `top` and above
    real(rk) :: top = 0.0_rk, reference = 0.0_rk !< z [m]
  contains
    procedure :: add_force
  end type pressure_load

contains

  !> Minus the integral of N_a p n over each face.
  subroutine add_force(self, mesh, density, force)
    class(pressure_load), intent(in) :: self
    type(fe_mesh), intent(in) :: mesh
    real(rk), intent(in) :: density(:)
    real(rk), intent(inout) :: force(:, :)
    real(rk) :: share(3, 4)
    integer :: i, a, nodes(4)
    do i = 1, size(self%faces%element)
      if (.not. element_is_there(mesh, self%faces%element(i))) cycle
      nodes = face_nodes(mesh, self%faces%element(i), self%faces%face(i))
      share = face_force(self, mesh%x(:, nodes))
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
      call integrate_wet_part(x, water_body(level=self%top), wet, needs_root=.false.)
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

  !> Face 1..6 that P1..P6 or HP1..HP6 names, 0 for any other word.
  pure integer function face_of_word(word) result(face)
    character(*), intent(in) :: word !< upper case
    integer :: length
    length = len_trim(word)
    face = 0
    if (length < 2) return
    if (word(:length - 1) /= 'P' .and. word(:length - 1) /= 'HP') return
    face = index('123456', word(length:length))
  end function face_of_word

  !> One face of each element as a surface without a name.
  pure function faces_of_elements(elements, face) result(faces)
    integer, intent(in) :: elements(:) !< positions
    integer, intent(in) :: face !< 1..6
    type(surface) :: faces
    allocate (faces%element(size(elements)), source=elements)
    allocate (faces%face(size(elements)), source=face)
  end function faces_of_elements
end module load_pressure
