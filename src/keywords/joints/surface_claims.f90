!> Which faces of solids the joints between surfaces have taken as slaves, and how much of each.
module surface_claims
  use kinds, only: rk
  use mesh_faces, only: face_table, find_face, insert_face, open_table
  use surface_segments, only: facet_set, surface_cover
  implicit none
  private
  public :: claims, open_claims, claim_facets

  !> What two joints may cover of one face together: more than the whole of it by this part means
  !> that they lie on each other. Faces that fit but for the mesher's digits stay below.
  real(rk), parameter :: most_cover = 1.01_rk

  type :: claims
    type(face_table) :: table
    integer, allocatable :: owner(:) !< (faces) the first joint that took the face
    real(rk), allocatable :: covered(:) !< (faces) part of it, by all joints
  end type claims

contains

  !> No face is taken yet.
  pure subroutine open_claims(num_nodes, capacity, taken)
    integer, intent(in) :: num_nodes !< of the mesh
    integer, intent(in) :: capacity !< most faces
    type(claims), intent(out) :: taken
    call open_table(num_nodes, capacity, taken%table)
    allocate (taken%owner(capacity), source=0)
    allocate (taken%covered(capacity), source=0.0_rk)
  end subroutine open_claims

  !> Takes the slave facets of a joint; tells the first one that another joint has covered.
  pure subroutine claim_facets(taken, joint, slave, cover, facet, earlier)
    type(claims), intent(inout) :: taken
    integer, intent(in) :: joint
    type(facet_set), intent(in) :: slave
    type(surface_cover), intent(in) :: cover
    integer, intent(out) :: facet !< taken before, 0 for none
    integer, intent(out) :: earlier !< the joint that has it
    integer :: f, number
    facet = 0
    earlier = 0
    do f = 1, size(slave%element)
      if (cover%bare(f) >= 1.0_rk) cycle
      number = find_face(taken%table, slave%node(:, f))
      if (number == 0) then
        call insert_face(taken%table, slave%node(:, f), number)
        taken%owner(number) = joint
      end if
      taken%covered(number) = taken%covered(number) + 1.0_rk - cover%bare(f)
      if (facet > 0 .or. taken%covered(number) <= most_cover) cycle
      facet = f
      earlier = taken%owner(number)
    end do
  end subroutine claim_facets
end module surface_claims
