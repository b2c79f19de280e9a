!> Matrix of the iteration on inelastic solids: K_eff, or K_eff less the loss of stiffness
!> (theory.md, 12).
module solid_tangent
  use kinds, only: rk
  use errors, only: error_type
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
    type(pattern) :: full_matrix !< both triangles, built for the first unsymmetric A
    real(rk), allocatable :: lost(:) !< values of A, in the system's pattern or the full one [N/m]
  contains
    procedure :: factorise, factorise_elastic, multiply_lost
  end type tangent_matrix

contains

  !> Factors K_eff.
  subroutine factorise_elastic(self, model, system, values, solver, error)
    class(tangent_matrix), intent(inout) :: self
    type(problem), intent(in) :: model
    type(dam_system), intent(in) :: system
    real(rk), intent(in) :: values(:) !< K_eff
    class(equilibrium_solver), intent(inout) :: solver
    type(error_type), allocatable, intent(out) :: error
    self%is_elastic = .true.
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
    real(rk), allocatable :: tangent(:)
    self%is_elastic = .false.
    call solver%costs%start('assemble', 'inelastic solids', 'inelastic')
    if (allocated(self%lost)) deallocate (self%lost)
    if (self%is_symmetric) then
      allocate (self%lost(size(values)))
      call lost_stiffness(model, system%numbers, answers, system%matrix, self%lost)
      tangent = values - weight*self%lost
    else
      if (.not. allocated(self%full_matrix%row)) call full_pattern(system%matrix, self%full_matrix)
      allocate (self%lost(size(self%full_matrix%row)))
      call lost_stiffness(model, system%numbers, answers, self%full_matrix, self%lost)
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
  end subroutine factorise

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
