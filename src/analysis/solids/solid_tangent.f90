!> Matrix of the iteration on inelastic solids: K_eff, or K_eff less the loss of stiffness
!> (theory.md, 12).
module solid_tangent
  use kinds, only: rk
  use analysis_state, only: last_matrix
  use errors, only: error_type, raise, system_failed
  use problem_definition, only: problem
  use matrix_pattern, only: pattern, full_pattern, spread_values
  use global_vectors, only: multiply
  use inelastic_forces, only: block_answer
  use inelastic_stiffness, only: lost_stiffness
  use step_system, only: dam_system
  use equilibrium, only: equilibrium_solver
  implicit none
  private
  public :: tangent_matrix

  type :: tangent_matrix
    logical :: is_elastic = .true. !< the factor is that of K_eff
    logical :: is_symmetric = .true. !< of A
    logical :: is_shared = .false. !< of A: no rank has all of it
    integer :: number = 0 !< of the factorisation
    real(rk) :: increment_size = 0.0_rk !< that the integrator has made K_eff for [s]
    type(pattern) :: full_matrix !< both triangles, built for the first unsymmetric A
    real(rk), allocatable :: lost(:) !< values of A, in the system's pattern or the full one [N/m]
  contains
    procedure :: factorise, factorise_elastic, multiply_lost, start_elastic
    procedure :: store, restore
    procedure, private :: factorise_lost
  end type tangent_matrix

contains

  !> The integrator has factored a new K_eff.
  pure subroutine start_elastic(self, increment_size)
    class(tangent_matrix), intent(inout) :: self
    real(rk), intent(in) :: increment_size !< of K_eff [s]
    self%is_elastic = .true.
    self%number = self%number + 1
    self%increment_size = increment_size
  end subroutine start_elastic

  !> Copies what makes the matrix to the state, unless the state has it. Where ranks share A, a run
  !> goes on from K_eff.
  subroutine store(self, matrix)
    class(tangent_matrix), intent(in) :: self
    type(last_matrix), intent(inout) :: matrix
    if (matrix%number == self%number) return
    matrix%number = self%number
    matrix%is_elastic = self%is_elastic .or. self%is_shared
    matrix%is_symmetric = self%is_symmetric
    matrix%increment_size = self%increment_size
    if (allocated(matrix%lost)) deallocate (matrix%lost)
    if (.not. matrix%is_elastic) matrix%lost = self%lost
  end subroutine store

  !> Factors the matrix of a state that was loaded; K_eff is factored.
  subroutine restore(self, model, system, values, weight, solver, matrix, error)
    class(tangent_matrix), intent(inout) :: self
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    real(rk), intent(in) :: values(:) !< K_eff
    real(rk), intent(in) :: weight !< of the forces of the solids
    class(equilibrium_solver), intent(inout) :: solver
    type(last_matrix), intent(in) :: matrix
    type(error_type), allocatable, intent(out) :: error
    integer :: num_values
    self%number = matrix%number
    self%is_elastic = matrix%is_elastic .or. system%matrix%is_shared
    self%is_symmetric = matrix%is_symmetric
    if (self%is_elastic) return
    if (.not. self%is_symmetric) call full_pattern(system%matrix, self%full_matrix)
    num_values = size(values)
    if (.not. self%is_symmetric) num_values = size(self%full_matrix%row)
    if (size(matrix%lost) /= num_values) then
      call raise(error, 'the matrix of the loaded state does not belong to this model', &
                 system_failed)
      return
    end if
    self%lost = matrix%lost
    call self%factorise_lost(model, system, values, weight, solver, error)
  end subroutine restore

  !> Factors K_eff.
  subroutine factorise_elastic(self, model, system, values, solver, error)
    class(tangent_matrix), intent(inout) :: self
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    real(rk), intent(in) :: values(:) !< K_eff
    class(equilibrium_solver), intent(inout) :: solver
    type(error_type), allocatable, intent(out) :: error
    self%is_elastic = .true.
    self%number = self%number + 1
    call solver%prepare_matrix(system%matrix, values, solver%weight, model%joints, &
                               system%operator, error)
  end subroutine factorise_elastic

  !> Factors K_eff - weight*A with the tangents of the last update. An error with `analysis_failed`
  !> means a singular matrix; a smaller increment may avoid it.
  subroutine factorise(self, model, system, answers, values, weight, solver, error)
    class(tangent_matrix), intent(inout) :: self
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    type(block_answer), intent(in) :: answers(:)
    real(rk), intent(in) :: values(:) !< K_eff
    real(rk), intent(in) :: weight !< of the forces of the solids
    class(equilibrium_solver), intent(inout) :: solver
    type(error_type), allocatable, intent(out) :: error
    self%is_elastic = .false.
    self%number = self%number + 1
    call solver%costs%start('assemble', 'inelastic solids', 'inelastic')
    if (allocated(self%lost)) deallocate (self%lost)
    self%is_shared = system%matrix%is_shared
    if (self%is_symmetric) then
      allocate (self%lost(size(values)))
      call lost_stiffness(model, system%numbers, answers, system%matrix, self%lost)
    else
      if (.not. allocated(self%full_matrix%row)) call full_pattern(system%matrix, self%full_matrix)
      allocate (self%lost(size(self%full_matrix%row)))
      call lost_stiffness(model, system%numbers, answers, self%full_matrix, self%lost)
    end if
    call solver%costs%stop()
    call self%factorise_lost(model, system, values, weight, solver, error)
  end subroutine factorise

  !> Factors K_eff - weight*A.
  subroutine factorise_lost(self, model, system, values, weight, solver, error)
    class(tangent_matrix), intent(inout) :: self
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    real(rk), intent(in) :: values(:) !< K_eff
    real(rk), intent(in) :: weight !< of the forces of the solids
    class(equilibrium_solver), intent(inout) :: solver
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: tangent(:)
    call solver%costs%start('assemble', 'inelastic solids', 'inelastic')
    if (self%is_symmetric) then
      tangent = values - weight*self%lost
    else
      allocate (tangent(size(self%lost)))
      call spread_values(system%matrix, values, self%full_matrix, tangent)
      tangent = tangent - weight*self%lost
    end if
    call solver%costs%stop()
    if (self%is_symmetric) then
      call solver%prepare_matrix(system%matrix, tangent, solver%weight, model%joints, &
                                 system%operator, error)
    else
      call solver%prepare_matrix(self%full_matrix, tangent, solver%weight, model%joints, &
                                 system%operator, error)
    end if
  end subroutine factorise_lost

  !> A x.
  subroutine multiply_lost(self, matrix, x, product)
    class(tangent_matrix), intent(in) :: self
    type(pattern), intent(in) :: matrix !< of the system
    real(rk), intent(in) :: x(:) !< (num_total)
    real(rk), intent(out) :: product(:) !< (num_total)
    if (self%is_elastic) then
      product = 0.0_rk
    else if (self%is_symmetric) then
      call multiply(matrix, self%lost, x, product)
    else
      call multiply(self%full_matrix, self%lost, x, product)
    end if
  end subroutine multiply_lost
end module solid_tangent
