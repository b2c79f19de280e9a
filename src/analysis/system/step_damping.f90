!> The damping matrix of a step: C = a M + b K + R.
!>
!> The two factors are those of the step and of the material with most elements. R has what differs:
!> other materials, guests, water that moves with the dam. Where R is zero, products with C follow
!> from those with M and K, and C is not assembled.
module step_damping
  use assemble_elements, only: assemble_damping
  use column_products, only: multiply_columns
  use damping_rayleigh, only: rayleigh_coefficients
  use dof_numbering, only: numbering
  use errors, only: error_type
  use global_vectors, only: multiply
  use guest_list, only: add_guest_matrices, any_has_matrix
  use guest_type, only: guest_reference, damping_matrix, mass_matrix, stiffness_matrix
  use kinds, only: rk
  use matrix_pattern, only: pattern, add_thin, drop_zeros
  use problem_definition, only: problem
  use run_ledger, only: ledger
  use step_plan, only: step
  implicit none
  private
  public :: damping_sum, build_damping_sum

  !> C of a step, but for modal damping.
  type :: damping_sum
    real(rk) :: of_mass = 0.0_rk !< a [1/s]
    real(rk) :: of_stiffness = 0.0_rk !< b [s]
    type(pattern), private :: thin !< the entries of R that are not zero
    real(rk), allocatable, private :: entries(:) !< their values [N s/m]; not allocated: R is zero
  contains
    procedure :: is_zero, add_rest_force, add_rest_forces, add_values
  end type damping_sum

contains

  !> Rayleigh damping of materials and step, and damping of guests.
  subroutine build_damping_sum(model, plan, guests, numbers, matrix, sum_of_parts, costs, error)
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    type(guest_reference), intent(in) :: guests(:) !< of the step
    type(numbering), intent(in) :: numbers
    type(pattern), intent(in) :: matrix
    type(damping_sum), intent(out) :: sum_of_parts
    type(ledger), intent(in) :: costs
    type(error_type), allocatable, intent(out) :: error
    real(rk), allocatable :: rest(:)
    logical :: materials_differ, has_rest
    real(rk) :: alpha, beta
    alpha = 0.0_rk
    beta = 0.0_rk
    if (plan%damping%ratio > 0.0_rk) then
      call rayleigh_coefficients(plan%damping%ratio, plan%damping%f1, plan%damping%f2, alpha, beta)
    end if
    associate (first => model%materials(most_used_material(model)), own => sum_of_parts)
      own%of_mass = alpha + first%alpha
      own%of_stiffness = beta + first%beta
      materials_differ = has_other_damping(model, first%alpha, first%beta)
      has_rest = materials_differ .or. any_has_matrix(guests, damping_matrix) &
                 .or. (own%of_mass > 0.0_rk .and. any_has_matrix(guests, mass_matrix)) &
                 .or. (own%of_stiffness > 0.0_rk .and. any_has_matrix(guests, stiffness_matrix))
      if (.not. has_rest .and. own%is_zero()) return
      call costs%start('assemble', 'damping', 'solver')
      if (materials_differ) then
        call assemble_damping(model, numbers, -first%alpha, -first%beta, matrix, rest, error)
        if (allocated(error)) return
      else if (has_rest) then
        allocate (rest(size(matrix%row)), source=0.0_rk)
      end if
      if (has_rest) then
        call add_guests(model, guests, numbers, matrix, own, rest, costs)
        call drop_zeros(matrix, rest, own%thin, own%entries)
      end if
      call costs%stop('assemble damping')
    end associate
  end subroutine build_damping_sum

  !> The damping of guests, less what the factors give to their masses and stiffnesses.
  subroutine add_guests(model, guests, numbers, matrix, own, rest, costs)
    type(problem), intent(in) :: model
    type(guest_reference), intent(in) :: guests(:)
    type(numbering), intent(in) :: numbers
    type(pattern), intent(in) :: matrix
    type(damping_sum), intent(in) :: own
    real(rk), intent(inout) :: rest(:) !< values of R [N s/m]
    type(ledger), intent(in) :: costs
    call add_guest_matrices(guests, damping_matrix, model, numbers, matrix, rest, costs)
    call take_away(mass_matrix, own%of_mass)
    call take_away(stiffness_matrix, own%of_stiffness)
  contains
    !> Takes a multiple of one kind of matrix away.
    subroutine take_away(kind, factor)
      integer, intent(in) :: kind !< of guest_type
      real(rk), intent(in) :: factor
      real(rk), allocatable :: values(:)
      if (.not. (factor > 0.0_rk .and. any_has_matrix(guests, kind))) return
      allocate (values(size(rest)), source=0.0_rk)
      call add_guest_matrices(guests, kind, model, numbers, matrix, values, costs)
      rest = rest - factor*values
    end subroutine take_away
  end subroutine add_guests

  !> The material with most elements; 1 without elements.
  pure integer function most_used_material(model)
    type(problem), intent(in) :: model
    integer :: used(size(model%materials)), e
    used = 0
    do e = 1, size(model%mesh%material_of_element)
      associate (material => model%mesh%material_of_element(e))
        if (material > 0) used(material) = used(material) + 1
      end associate
    end do
    most_used_material = maxloc(used, 1)
  end function most_used_material

  !> Whether a material has another damping.
  pure logical function has_other_damping(model, alpha, beta)
    type(problem), intent(in) :: model
    real(rk), intent(in) :: alpha, beta
    has_other_damping = any(abs(model%materials%alpha - alpha) > 0.0_rk &
                            .or. abs(model%materials%beta - beta) > 0.0_rk)
  end function has_other_damping

  !> Whether nothing damps.
  pure logical function is_zero(self)
    class(damping_sum), intent(in) :: self
    is_zero = .not. (self%of_mass > 0.0_rk .or. self%of_stiffness > 0.0_rk &
                     .or. allocated(self%entries))
  end function is_zero

  !> Adds R v.
  subroutine add_rest_force(self, v, force)
    class(damping_sum), intent(in) :: self
    real(rk), intent(in) :: v(:) !< (num_total)
    real(rk), intent(inout) :: force(:) !< (num_total)
    real(rk) :: product(size(v))
    if (.not. allocated(self%entries)) return
    call multiply(self%thin, self%entries, v, product)
    force = force + product
  end subroutine add_rest_force

  !> Adds R v for many velocities, over the free unknowns; prescribed ones are at rest.
  subroutine add_rest_forces(self, v, force)
    class(damping_sum), intent(in) :: self
    real(rk), intent(in), contiguous :: v(:, :) !< (num_free, velocities)
    real(rk), intent(inout) :: force(:, :) !< (num_free, velocities)
    real(rk), allocatable :: product(:, :)
    if (.not. allocated(self%entries)) return
    allocate (product, mold=force)
    call multiply_columns(self%thin, self%entries, v, product)
    force = force + product
  end subroutine add_rest_forces

  !> Adds a multiple of C, less the part of the mass, to the values of a matrix.
  subroutine add_values(self, factor, matrix, stiffness, values)
    class(damping_sum), intent(in) :: self
    real(rk), intent(in) :: factor
    type(pattern), intent(in) :: matrix
    real(rk), intent(in) :: stiffness(:) !< values of K
    real(rk), intent(inout) :: values(:)
    if (self%of_stiffness > 0.0_rk) values = values + (factor*self%of_stiffness)*stiffness
    if (allocated(self%entries)) call add_thin(factor, self%thin, self%entries, matrix, values)
  end subroutine add_values
end module step_damping
