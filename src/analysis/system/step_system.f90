!> The equations of one step: numbering, matrices, load patterns, joints as one operator.
module step_system
  use kinds, only: rk
  use errors, only: error_type
  use problem_definition, only: problem
  use analysis_state, only: motion, state
  use block_parts, only: elements_here
  use assemble_heat, only: assemble_thermal_force
  use row_tables, only: row_table
  use step_plan, only: step
  use dof_numbering, only: numbering
  use column_products, only: multiply_columns, multiply_pair
  use constraint_elimination, only: number_step
  use dense_products, only: times, transposed_times
  use global_vectors, only: diagonal, dot, multiply
  use matrix_pattern, only: pattern, add_thin, drop_zeros
  use matrix_rows, only: lay_out_rows
  use solver_petsc, only: settle_solver
  use pattern_builder, only: list_cells, build_pattern
  use assemble_elements, only: assemble_stiffness, assemble_mass, assemble_origins
  use guest_list, only: add_guest_matrices, guests_of_step
  use guest_type, only: guest_reference, mass_matrix, stiffness_matrix
  use joint_operator, only: jump_operator, build_jump_operator
  use joint_separators, only: find_separators, fits_the_end
  use ranks, only: add_over_ranks
  use step_damping, only: build_damping_sum, damping_sum
  use step_loads, only: load_group, support, gather_loads, gather_supports
  use run_ledger, only: ledger
  use unknown_parts, only: unknown_part
  implicit none
  private
  public :: dam_system, build_structure, build_inertia, build_damping, build_loads, build_origins
  public :: build_thermal_force

  type :: dam_system
    type(numbering) :: numbers
    type(pattern) :: matrix
    real(rk), allocatable :: stiffness(:) !< values of K, without joints [N/m]
    real(rk), allocatable :: diagonal(:) !< (num_total) of K [N/m]
    !> (num_total) sum of K_e u_0 over the elements, u_0 the displacements at which they have no
    !> stress; in models with *MODEL CHANGE only [N]
    real(rk), allocatable :: origin_force(:)
    real(rk) :: origin_energy = 0.0_rk !< sum of 1/2 u_0 K_e u_0 [J]
    !> (num_total) force of the thermal strain at the end of the increment; where a material expands
    !> [N]
    real(rk), allocatable :: thermal_force(:)
    real(rk) :: thermal_energy = 0.0_rk !< of elements that are held at their origins [J]
    !> Values of M, added mass included; size 0 in a static step, and once an integrator is content
    !> with the entries that are not zero
    real(rk), allocatable :: mass(:)
    type(pattern) :: mass_pattern !< of the entries of M that are not zero
    real(rk), allocatable :: mass_entries(:) !< their values [kg]
    type(damping_sum) :: damping !< C, but for modal damping
    !> (num_total, modes) U of modal damping: C has the term U U^T; no columns without it
    real(rk), allocatable :: modal(:, :)
    type(jump_operator) :: operator
    type(load_group), allocatable :: groups(:)
    type(support), allocatable :: supports(:)
  contains
    procedure :: find_damping_force, find_damping_forces, find_rate_forces
    procedure :: add_mass, add_damping
    procedure :: find_elastic, stored_energy
    procedure :: add_modal_force
    procedure :: add_warming, set_thermal
  end type dam_system

contains

  !> C v; zero where nothing damps.
  subroutine find_damping_force(self, v, force)
    class(dam_system), intent(in) :: self
    real(rk), intent(in) :: v(:) !< (num_total)
    real(rk), intent(out) :: force(:) !< (num_total)
    real(rk), allocatable :: product(:)
    force = 0.0_rk
    if (self%damping%of_stiffness > 0.0_rk) then
      call multiply(self%matrix, self%stiffness, v, force)
      force = self%damping%of_stiffness*force
    end if
    if (self%damping%of_mass > 0.0_rk) then
      allocate (product(size(v)))
      call multiply(self%mass_pattern, self%mass_entries, v, product)
      force = force + self%damping%of_mass*product
    end if
    call self%damping%add_rest_force(v, force)
    call self%add_modal_force(v, force)
  end subroutine find_damping_force

  !> The force of the undamaged elements at q, and C a. The stiffness matrix is read once for both.
  subroutine find_rate_forces(self, q, a, inertia, elastic, viscous_rate)
    class(dam_system), intent(in) :: self
    real(rk), intent(in) :: q(:), a(:) !< (num_total) [m], [m/s2]
    real(rk), intent(in) :: inertia(:) !< (num_total) M a [N]
    real(rk), contiguous, intent(out) :: elastic(:), viscous_rate(:) !< (num_total) [N], [N/s]
    if (self%damping%of_stiffness > 0.0_rk) then
      call multiply_pair(self%matrix, self%stiffness, q, a, elastic, viscous_rate)
      viscous_rate = self%damping%of_stiffness*viscous_rate + self%damping%of_mass*inertia
    else
      call multiply(self%matrix, self%stiffness, q, elastic)
      viscous_rate = self%damping%of_mass*inertia
    end if
    call subtract_origins(self, elastic)
    call self%damping%add_rest_force(a, viscous_rate)
    call self%add_modal_force(a, viscous_rate)
  end subroutine find_rate_forces

  !> Adds the force of modal damping.
  subroutine add_modal_force(self, v, force)
    class(dam_system), intent(in) :: self
    real(rk), intent(in) :: v(:) !< (num_total)
    real(rk), intent(inout) :: force(:) !< (num_total)
    integer :: k
    do k = 1, size(self%modal, 2)
      associate (u => self%modal(:, k))
        force = force + dot(self%matrix%part, u, v)*u
      end associate
    end do
  end subroutine add_modal_force

  !> C v for many velocities, over the free unknowns; prescribed ones are at rest.
  subroutine find_damping_forces(self, v, force)
    class(dam_system), intent(in) :: self
    real(rk), intent(in), contiguous :: v(:, :) !< (num_free, velocities)
    real(rk), intent(out) :: force(:, :) !< (num_free, velocities)
    real(rk), allocatable :: product(:, :), columns(:, :)
    force = 0.0_rk
    if (self%damping%of_stiffness > 0.0_rk) then
      call multiply_columns(self%matrix, self%stiffness, v, force)
      force = self%damping%of_stiffness*force
    end if
    if (self%damping%of_mass > 0.0_rk) then
      allocate (product, mold=force)
      call multiply_columns(self%mass_pattern, self%mass_entries, v, product)
      force = force + self%damping%of_mass*product
    end if
    call self%damping%add_rest_forces(v, force)
    if (size(self%modal, 2) > 0) then
      columns = self%modal(:size(v, 1), :)
      force = force + times(columns, transposed_times(columns, v))
    end if
  end subroutine find_damping_forces

  !> The force of the undamaged elements: K q, less that of their origins and thermal strains.
  subroutine find_elastic(self, q, force)
    class(dam_system), intent(in) :: self
    real(rk), intent(in) :: q(:) !< (num_total) [m]
    real(rk), intent(out) :: force(:) !< (num_total) [N]
    call multiply(self%matrix, self%stiffness, q, force)
    call subtract_origins(self, force)
  end subroutine find_elastic

  !> Takes the forces of origins and of thermal strains away.
  subroutine subtract_origins(self, force)
    type(dam_system), intent(in) :: self
    real(rk), intent(inout) :: force(:) !< (num_total) [N]
    if (allocated(self%origin_force)) force = force - self%origin_force
    if (allocated(self%thermal_force)) force = force - self%thermal_force
  end subroutine subtract_origins

  !> Adds the change of the thermal force over the increment to forces that have the elastic force
  !> of its start.
  subroutine add_warming(self, before, factor, force)
    class(dam_system), intent(in) :: self
    type(motion), intent(in) :: before
    real(rk), intent(in) :: factor
    real(rk), intent(inout) :: force(:) !< (num_free or num_total) [N]
    integer :: n
    n = size(force)
    if (.not. allocated(self%thermal_force)) return
    force = force + factor*(self%thermal_force(:n) - before%thermal(:n))
  end subroutine add_warming

  !> Gives the thermal force to a motion.
  subroutine set_thermal(self, own)
    class(dam_system), intent(in) :: self
    type(motion), intent(inout) :: own
    if (.not. allocated(self%thermal_force)) return
    own%thermal = self%thermal_force
    own%thermal_energy = self%thermal_energy
  end subroutine set_thermal

  !> The energy of the undamaged elements.
  real(rk) function stored_energy(self, q, elastic) result(energy)
    class(dam_system), intent(in) :: self
    real(rk), intent(in) :: q(:) !< (num_total) [m]
    real(rk), intent(in) :: elastic(:) !< (num_total) from find_elastic [N]
    energy = 0.5_rk*dot(self%matrix%part, q, elastic)
    if (allocated(self%origin_force)) then
      energy = energy - 0.5_rk*dot(self%matrix%part, q, self%origin_force) + self%origin_energy
    end if
    if (allocated(self%thermal_force)) then
      energy = energy - 0.5_rk*dot(self%matrix%part, q, self%thermal_force) + self%thermal_energy
    end if
  end function stored_energy

  !> Adds a multiple of M to the values of a matrix.
  subroutine add_mass(self, factor, values)
    class(dam_system), intent(in) :: self
    real(rk), intent(in) :: factor
    real(rk), intent(inout) :: values(:)
    call add_thin(factor, self%mass_pattern, self%mass_entries, self%matrix, values)
  end subroutine add_mass

  !> Adds a multiple of C, without modal damping, to the values of a matrix.
  subroutine add_damping(self, factor, values)
    class(dam_system), intent(in) :: self
    real(rk), intent(in) :: factor
    real(rk), intent(inout) :: values(:)
    if (self%damping%of_mass > 0.0_rk) call self%add_mass(factor*self%damping%of_mass, values)
    call self%damping%add_values(factor, self%matrix, self%stiffness, values)
  end subroutine add_damping

  !> Numbering, pattern, stiffness of solids and guests, joints.
  subroutine build_structure(model, plan, system, costs, error)
    type(problem), intent(in), target :: model
    type(step), intent(in) :: plan
    type(dam_system), intent(out) :: system
    type(ledger), intent(in) :: costs
    type(error_type), allocatable, intent(out) :: error
    type(guest_reference), allocatable :: guests(:)
    type(row_table) :: cells
    call costs%start('assemble', 'structure', 'solver')
    call guests_of_step(model, plan, guests)
    call number_step(model%mesh, model%joints, model%guests, plan%fixities, system%numbers, error)
    if (allocated(error)) return
    call list_cells(model%mesh, guests, cells, elements_here(model%inelastic))
    call build_pattern(system%numbers, cells, system%matrix)
    if (allocated(model%mesh%rank_of_element)) then
      call lay_out_rows(model%mesh, system%numbers, cells, system%matrix)
      system%matrix%layout%solver = model%equation_solver
      call settle_solver(system%matrix%layout)
    end if
    call build_jump_operator(system%numbers, model%mesh, model%joints, system%operator)
    call place_joints(plan%procedure%has_inertia, system)
    call assemble_stiffness(model, system%numbers, system%matrix, system%stiffness, error)
    if (allocated(error)) return
    call add_guest_matrices(guests, stiffness_matrix, model, system%numbers, system%matrix, &
                            system%stiffness, costs)
    allocate (system%mass(0), system%diagonal(system%matrix%num_total))
    allocate (system%modal(system%matrix%num_total, 0))
    call diagonal(system%matrix, system%stiffness, system%diagonal)
    call costs%stop('assemble structure')
  end subroutine build_structure

  !> Where the unknowns of joints stand in a factor: few at its end. Many stand anywhere in motion,
  !> where parts of the matrix near each group give its compliance; else each group is a separator.
  subroutine place_joints(has_inertia, system)
    logical, intent(in) :: has_inertia
    type(dam_system), intent(inout) :: system
    associate (matrix => system%matrix)
      if (fits_the_end(system%operator, matrix%num_free, has_inertia)) return
      matrix%orders_freely = has_inertia
      if (matrix%orders_freely) then
        matrix%num_last = 0
        return
      end if
      call find_separators(system%numbers, system%operator, matrix%group, matrix%jump, &
                           matrix%joined)
    end associate
  end subroutine place_joints

  !> The forces of elements at their origins and of their thermal strains, where the model has any.
  subroutine build_origins(model, now, system, costs, error)
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(dam_system), intent(inout) :: system
    type(ledger), intent(in) :: costs
    type(error_type), allocatable, intent(out) :: error
    if (allocated(now%origin)) then
      call costs%start('assemble', 'stages', 'stages')
      allocate (system%origin_force(system%matrix%num_total))
      call assemble_origins(model, system%numbers, now%origin, system%origin_force, &
                            system%origin_energy, error)
      call costs%stop()
      if (allocated(error)) return
      if (system%matrix%is_shared) call share(system%matrix%part, system%origin_force, &
                                              system%origin_energy)
    end if
    call build_thermal_force(model, now, system, costs)
  end subroutine build_origins

  !> Adds force and energy of the elements of all ranks.
  subroutine share(part, force, energy)
    type(unknown_part), intent(in) :: part
    real(rk), contiguous, intent(inout) :: force(:) !< (num_total) [N]
    real(rk), intent(inout) :: energy !< [J]
    real(rk) :: energies(1)
    call part%add(force)
    energies = energy
    call add_over_ranks(energies)
    energy = energies(1)
  end subroutine share

  !> The force of the thermal strains of a state, where a material expands.
  subroutine build_thermal_force(model, now, system, costs)
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(dam_system), intent(inout) :: system
    type(ledger), intent(in) :: costs
    if (.not. allocated(now%heat%reference)) return
    call costs%start('assemble', 'temperature', 'temperature')
    if (.not. allocated(system%thermal_force)) then
      allocate (system%thermal_force(system%matrix%num_total))
    end if
    call assemble_thermal_force(model, system%numbers, now%heat, now%origin, &
                                system%thermal_force, system%thermal_energy)
    if (system%matrix%is_shared) call share(system%matrix%part, system%thermal_force, &
                                            system%thermal_energy)
    call costs%stop()
  end subroutine build_thermal_force

  !> Mass of the solids and of the guests.
  subroutine build_inertia(model, plan, system, costs, error)
    type(problem), intent(in), target :: model
    type(step), intent(in) :: plan
    type(dam_system), intent(inout) :: system
    type(ledger), intent(in) :: costs
    type(error_type), allocatable, intent(out) :: error
    type(guest_reference), allocatable :: guests(:)
    call costs%start('assemble', 'mass', 'solver')
    call guests_of_step(model, plan, guests)
    call assemble_mass(model, system%numbers, system%matrix, system%mass, error)
    if (allocated(error)) return
    call add_guest_matrices(guests, mass_matrix, model, system%numbers, system%matrix, &
                            system%mass, costs)
    call drop_zeros(system%matrix, system%mass, system%mass_pattern, system%mass_entries)
    call costs%stop('assemble mass')
  end subroutine build_inertia

  !> Rayleigh damping of materials and step, and damping of guests.
  subroutine build_damping(model, plan, system, costs, error)
    type(problem), intent(in), target :: model
    type(step), intent(in) :: plan
    type(dam_system), intent(inout) :: system
    type(ledger), intent(in) :: costs
    type(error_type), allocatable, intent(out) :: error
    type(guest_reference), allocatable :: guests(:)
    call guests_of_step(model, plan, guests)
    call build_damping_sum(model, plan, guests, system%numbers, system%matrix, system%damping, &
                           costs, error)
  end subroutine build_damping

  !> Load patterns and supports. Base motion needs the mass, so `build_inertia` comes first.
  subroutine build_loads(model, plan, u, system, costs)
    type(problem), intent(in), target :: model
    type(step), intent(in) :: plan
    real(rk), intent(in) :: u(:, :) !< (3, nodes) at the start of the step [m]
    type(dam_system), intent(inout) :: system
    type(ledger), intent(in) :: costs
    call gather_loads(model, plan, system%numbers, system%matrix, system%mass, system%groups, costs)
    call costs%start('assemble', 'supports', 'solver')
    call gather_supports(plan, system%numbers, u, system%supports)
    call costs%stop()
  end subroutine build_loads
end module step_system
