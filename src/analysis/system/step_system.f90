!> The equations of one step: numbering, matrices, load patterns, joints as one operator.
module step_system
  use kinds, only: rk
  use errors, only: error_type
  use problem_definition, only: problem
  use row_tables, only: row_table
  use step_plan, only: step
  use dof_numbering, only: numbering
  use constraint_elimination, only: number_step
  use global_vectors, only: diagonal
  use matrix_pattern, only: pattern, drop_zeros
  use pattern_builder, only: list_cells, build_pattern
  use assemble_elements, only: assemble_stiffness, assemble_mass, assemble_damping, add_nodal_mass
  use assemble_forces, only: sum_added_mass
  use coupling_stiffness, only: add_coupling_stiffness
  use damping_rayleigh, only: rayleigh_coefficients
  use joint_operator, only: jump_operator, build_jump_operator
  use step_loads, only: load_group, support, gather_loads, gather_supports
  use run_ledger, only: ledger
  implicit none
  private
  public :: dam_system, build_structure, add_couplings, build_inertia, build_damping, build_loads

  type :: dam_system
    type(numbering) :: numbers
    type(pattern) :: matrix
    real(rk), allocatable :: stiffness(:) !< values of K, without joints [N/m]
    real(rk), allocatable :: diagonal(:) !< (num_total) of K [N/m]
    real(rk), allocatable :: mass(:) !< values of M, added mass included; size 0 in a static step
    type(pattern) :: mass_pattern !< of the entries of M that are not zero, for products
    real(rk), allocatable :: mass_entries(:) !< their values [kg]
    real(rk), allocatable :: damping(:) !< values of C; size 0 where nothing damps
    type(jump_operator) :: operator
    type(load_group), allocatable :: groups(:)
    type(support), allocatable :: supports(:)
  end type dam_system

contains

  !> Numbering, pattern, stiffness of the solids and joints.
  subroutine build_structure(scene, plan, system, error)
    type(problem), intent(in) :: scene
    type(step), intent(in) :: plan
    type(dam_system), intent(out) :: system
    type(error_type), allocatable, intent(out) :: error
    type(row_table) :: cells
    call number_step(scene%mesh, scene%joints, scene%ties, plan%fixities, system%numbers, error)
    if (allocated(error)) return
    call list_cells(scene%mesh, scene%joints, scene%couplings, cells)
    call build_pattern(system%numbers, cells, system%matrix)
    call build_jump_operator(system%numbers, scene%joints, system%operator)
    call assemble_stiffness(scene, system%numbers, system%matrix, system%stiffness, error)
    allocate (system%mass(0), system%damping(0))
  end subroutine build_structure

  !> Adds the springs between faces of different meshes to the stiffness.
  subroutine add_couplings(scene, system, costs)
    type(problem), intent(in) :: scene
    type(dam_system), intent(inout) :: system
    type(ledger), intent(inout) :: costs !< gets a part for each of them
    integer :: i
    do i = 1, size(scene%couplings)
      call costs%start('assemble', scene%couplings(i)%name, 'coupling')
      call add_coupling_stiffness(system%numbers, scene%couplings(i), system%matrix, &
                                  system%stiffness)
      call costs%stop()
    end do
    allocate (system%diagonal(system%matrix%num_total))
    call diagonal(system%matrix, system%stiffness, system%diagonal)
  end subroutine add_couplings

  !> Mass of the solids and of the water that moves with them.
  subroutine build_inertia(scene, plan, system, error)
    type(problem), intent(in) :: scene
    type(step), intent(in) :: plan
    type(dam_system), intent(inout) :: system
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: blocks(:, :, :)
    call assemble_mass(scene, system%numbers, system%matrix, system%mass, error)
    if (allocated(error)) return
    call sum_added_mass(scene, plan%loads, blocks)
    call add_nodal_mass(system%numbers, blocks, system%matrix, system%mass)
    call drop_zeros(system%matrix, system%mass, system%mass_pattern, system%mass_entries)
  end subroutine build_inertia

  !> Rayleigh damping of materials and step, where there is any.
  subroutine build_damping(scene, plan, system, error)
    type(problem), intent(in) :: scene
    type(step), intent(in) :: plan
    type(dam_system), intent(inout) :: system
    type(error_type), allocatable, intent(out) :: error
    real(rk) :: alpha, beta
    alpha = 0.0_rk
    beta = 0.0_rk
    if (plan%damping_ratio > 0.0_rk) then
      call rayleigh_coefficients(plan%damping_ratio, plan%damping_f1, plan%damping_f2, alpha, beta)
    end if
    if (alpha + beta + sum(abs(scene%materials%alpha) + abs(scene%materials%beta)) <= 0.0_rk) return
    call assemble_damping(scene, system%numbers, alpha, beta, system%matrix, system%damping, error)
  end subroutine build_damping

  !> Load patterns and supports; after the mass, which base motion needs.
  subroutine build_loads(scene, plan, u, system)
    type(problem), intent(in) :: scene
    type(step), intent(in) :: plan
    real(rk), intent(in) :: u(:, :) !< (3, nodes) at the start of the step [m]
    type(dam_system), intent(inout) :: system
    call gather_loads(scene, plan, system%numbers, system%matrix, system%mass, system%groups)
    call gather_supports(plan, system%numbers, u, system%supports)
  end subroutine build_loads
end module step_system
