!> The work of the thermal strains in the energy balance: less the mean stress of an increment times
!> the change of the thermal strain (theory.md, 16). The thermal force of a body that is free does
!> work, which the strain of the body stores, although no stress does any: the balance is measured
!> against this work, too.
module thermal_work
  use analysis_state, only: state
  use global_vectors, only: dot
  use inelastic_blocks, only: inelastic_block
  use kinds, only: rk
  use material_points, only: point_state
  use problem_definition, only: problem
  use ranks, only: add_over_ranks
  use unknown_parts, only: unknown_part
  implicit none
  private
  public :: add_thermal_work

contains

  !> The elastic stress does its work through the thermal force. What points that are not elastic
  !> lack of it counts too; without it the balance would take it for numerical dissipation.
  subroutine add_thermal_work(model, part, before, after)
    type(problem), intent(in) :: model
    type(unknown_part), intent(in) :: part
    type(state), intent(in) :: before
    type(state), intent(inout) :: after
    real(rk) :: elastic, lost
    real(rk), allocatable :: of_block(:)
    integer :: i
    if (.not. allocated(after%motion%thermal)) return
    associate (old => before%motion, new => after%motion)
      elastic = new%thermal_energy - old%thermal_energy &
                - 0.5_rk*dot(part, old%q + new%q, new%thermal - old%thermal)
    end associate
    allocate (of_block(size(after%points)), source=0.0_rk)
    do i = 1, size(after%points)
      if (.not. (allocated(after%points(i)%thermal) .and. model%inelastic(i)%is_here())) cycle
      of_block(i) = lost_work(model%inelastic(i), before%points(i), after%points(i))
    end do
    call add_over_ranks(of_block)
    lost = sum(of_block)
    after%energy%temperature = after%energy%temperature + elastic + lost
    after%energy%numerical = after%energy%numerical + lost
    after%energy%largest = max(after%energy%largest, abs(after%motion%thermal_energy))
  end subroutine add_thermal_work

  !> The mean of D eps - sigma times the change of the thermal strain, summed over a block.
  pure real(rk) function lost_work(part, old, new) result(work)
    type(inelastic_block), intent(in) :: part
    type(point_state), intent(in) :: old, new
    real(rk) :: lost(6)
    integer :: e, q, p
    work = 0.0_rk
    if (all(new%is_elastic)) return
    do e = 1, size(part%elements)
      do q = 1, part%points_of_element
        p = (e - 1)*part%points_of_element + q
        lost = 0.0_rk
        if (.not. old%is_elastic(p)) lost = matmul(part%d, old%strain(:, p)) - old%stress(:, p)
        if (.not. new%is_elastic(p)) then
          lost = lost + matmul(part%d, new%strain(:, p)) - new%stress(:, p)
        end if
        work = work + 0.5_rk*part%weight(q, e)*dot_product(lost, new%thermal(:, p) &
                                                           - old%thermal(:, p))
      end do
    end do
  end function lost_work
end module thermal_work
