!> Energies of inelastic solids in addition to 1/2 u K u of the elastic solid.
module inelastic_energy
  use kinds, only: rk
  use problem_definition, only: problem
  use inelastic_blocks, only: inelastic_block
  use material_points, only: point_state, stored_energy, fracture_energy, crushing_energy
  implicit none
  private
  public :: solid_work, sum_solid_work

  !> Energies of all inelastic solids [J].
  type :: solid_work
    real(rk) :: stored = 0.0_rk !< minus 1/2 eps D eps of the elastic solid; at most 0
    real(rk) :: fracture = 0.0_rk !< dissipated, crushing included
    real(rk) :: crushing = 0.0_rk !< dissipated in compression
  end type solid_work

contains

  !> Sums over the points that have yielded or cracked; all others contribute nothing.
  subroutine sum_solid_work(model, points, total)
    type(problem), intent(in) :: model
    type(point_state), intent(in) :: points(:) !< (blocks)
    type(solid_work), intent(out) :: total
    type(solid_work) :: own
    integer :: i
    do i = 1, size(points)
      if (all(points(i)%is_elastic)) cycle
      call sum_block(model, model%inelastic(i), points(i), own)
      total%stored = total%stored + own%stored
      total%fracture = total%fracture + own%fracture
      total%crushing = total%crushing + own%crushing
    end do
  end subroutine sum_solid_work

  !> One block.
  subroutine sum_block(model, part, points, total)
    type(problem), intent(in) :: model
    type(inelastic_block), intent(in) :: part
    type(point_state), intent(in) :: points
    type(solid_work), intent(out) :: total
    real(rk) :: d(6, 6)
    integer :: e, q, p
    call model%materials(part%material)%law%elastic_stiffness(d)
    do e = 1, size(part%elements)
      do q = 1, part%points_of_element
        p = (e - 1)*part%points_of_element + q
        if (points%is_elastic(p)) cycle
        associate (strain => points%strain(:, p), energy => points%energy(:, p), &
                   volume => part%weight(q, e))
          total%stored = total%stored + volume*(energy(stored_energy) &
                                                - 0.5_rk*dot_product(strain, matmul(d, strain)))
          total%fracture = total%fracture &
                           + volume*(energy(fracture_energy) + energy(crushing_energy))
          total%crushing = total%crushing + volume*energy(crushing_energy)
        end associate
      end do
    end do
  end subroutine sum_block
end module inelastic_energy
