!> Scalars that follow from the stresses at integration points: the equivalent stress of von Mises,
!> and the elastic energy per volume.
module derived_fields
  use analysis_state, only: state
  use field_type, only: result_field
  use kinds, only: rk
  use material_law, only: material
  use material_points, only: stored_energy
  use node_means, only: average_at_nodes
  use problem_definition, only: problem
  use stress_fields, only: recovered_fields
  use recovery_plans, only: recovery_plan
  use tensor6, only: trace, von_mises
  implicit none
  private
  public :: mises_on_nodes, mises_of_solids, energy_on_nodes, energy_of_solids

contains

  !> MISES on nodes, of the mean tensor.
  subroutine mises_on_nodes(self, model, now, stresses, values)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(recovered_fields), intent(inout) :: stresses
    real(rk), allocatable, intent(out) :: values(:, :) !< (1, nodes) [Pa]
    integer :: i
    call stresses%need_node_stress(model, now)
    allocate (values(1, size(stresses%node_stress, 2)))
    do i = 1, size(values, 2)
      values(1, i) = von_mises(stresses%node_stress(:, i))
    end do
  end subroutine mises_on_nodes

  !> MISES at points.
  subroutine mises_of_solids(self, model, now, stresses, solids, values)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(recovered_fields), intent(inout) :: stresses
    integer, intent(in) :: solids(:)
    real(rk), allocatable, intent(out) :: values(:, :, :) !< (1, max_points, solids) [Pa]
    integer :: s, q
    call stresses%need_points(model, now)
    allocate (values(1, size(stresses%point_stress, 2), size(solids)))
    do s = 1, size(solids)
      do q = 1, size(values, 2)
        values(1, q, s) = von_mises(stresses%point_stress(:, q, solids(s)))
      end do
    end do
  end subroutine mises_of_solids

  !> ENER on nodes: means of the nearest points.
  subroutine energy_on_nodes(self, model, now, stresses, values)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(recovered_fields), intent(inout) :: stresses
    real(rk), allocatable, intent(out) :: values(:, :) !< (1, nodes) [J/m3]
    real(rk), allocatable :: energy(:, :, :)
    integer :: s
    logical, allocatable :: is_bounded(:)
    call stresses%need_points(model, now)
    allocate (energy(1, size(stresses%point_stress, 2), stresses%plan%num_solids), source=0.0_rk)
    do s = 1, size(energy, 3)
      call find_energy(model, stresses%plan, now, s, stresses%point_stress(:, :, s), &
                       energy(1, :, s))
    end do
    allocate (values(1, model%mesh%num_nodes), source=0.0_rk)
    allocate (is_bounded(stresses%plan%num_solids), source=.true.)
    call average_at_nodes(stresses%plan, energy, is_bounded, values)
  end subroutine energy_on_nodes

  !> ENER at points.
  subroutine energy_of_solids(self, model, now, stresses, solids, values)
    class(result_field), intent(in) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(recovered_fields), intent(inout) :: stresses
    integer, intent(in) :: solids(:)
    real(rk), allocatable, intent(out) :: values(:, :, :) !< (1, max_points, solids) [J/m3]
    integer :: k
    call stresses%need_points(model, now)
    allocate (values(1, size(stresses%point_stress, 2), size(solids)), source=0.0_rk)
    do k = 1, size(solids)
      call find_energy(model, stresses%plan, now, solids(k), &
                       stresses%point_stress(:, :, solids(k)), values(1, :, k))
    end do
  end subroutine energy_of_solids

  !> Elastic energy at the points of one solid: as its law gives it, else from the stress. That of
  !> an absent element stays zero.
  subroutine find_energy(model, plan, now, solid, stress, energy)
    type(problem), intent(in) :: model
    type(recovery_plan), intent(in) :: plan
    type(state), intent(in) :: now
    integer, intent(in) :: solid !< position in the plan
    real(rk), intent(in) :: stress(:, :) !< (6, max_points) [Pa]
    real(rk), intent(inout) :: energy(:) !< (max_points) zero before [J/m3]
    integer :: q, n, before, number
    n = plan%num_points(solid)
    if (plan%inelastic_block(solid) > 0) then
      before = plan%points_before(solid)
      energy(:n) = now%points(plan%inelastic_block(solid))% &
                   energy(stored_energy, before + 1:before + n)
      return
    end if
    number = model%mesh%material_of_element(plan%element_of_solid(solid))
    if (number == 0) return ! absent
    associate (own => model%materials(number))
      do q = 1, n
        energy(q) = elastic_energy(own, stress(:, q))
      end do
    end associate
  end subroutine find_energy

  !> Energy per volume of Hooke's law under a stress [J/m3].
  pure real(rk) function elastic_energy(own, stress) result(energy)
    type(material), intent(in) :: own !< elastic
    real(rk), intent(in) :: stress(6) !< [Pa]
    energy = 0.5_rk*((1.0_rk + own%poisson)*(sum(stress(:3)**2) + 2.0_rk*sum(stress(4:)**2)) - &
                     own%poisson*trace(stress)**2)/own%young
  end function elastic_energy
end module derived_fields
