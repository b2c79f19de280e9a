!> C of a step as a M + b K + R against C that is summed over elements and guests.
module matrix_guest
  use dam_mesh, only: fe_mesh
  use dof_numbering, only: numbering
  use guest_type, only: guest
  use kinds, only: rk
  use matrix_pattern, only: pattern
  implicit none
  private
  public :: corner_guest

  !> A spring, a dashpot and a mass at the first unknown.
  type, extends(guest) :: corner_guest
  contains
    procedure :: has_matrix
    procedure :: add_matrix
  end type corner_guest

contains

  pure logical function has_matrix(self, kind)
    class(corner_guest), intent(in) :: self
    integer, intent(in) :: kind
    has_matrix = kind > 0 .and. allocated(self%name)
  end function has_matrix

  !> 3e9, 5e7 and 2e6 for stiffness, damping and mass.
  subroutine add_matrix(self, kind, mesh, numbers, matrix, values)
    class(corner_guest), intent(in) :: self
    integer, intent(in) :: kind
    type(fe_mesh), intent(in) :: mesh
    type(numbering), intent(in) :: numbers
    type(pattern), intent(in) :: matrix
    real(rk), intent(inout) :: values(:)
    real(rk), parameter :: size_of(3) = [3.0e9_rk, 5.0e7_rk, 2.0e6_rk]
    if (.not. (self%has_matrix(kind) .and. mesh%num_nodes > 0 .and. numbers%num_free > 0)) return
    values(matrix%column_start(1)) = values(matrix%column_start(1)) + size_of(kind)
  end subroutine add_matrix
end module matrix_guest

program test_step_damping
  use arch_model, only: make_arch
  use assemble_elements, only: assemble_damping
  use damping_rayleigh, only: rayleigh_coefficients
  use errors, only: error_type
  use kinds, only: rk
  use material_elastic, only: elastic_law
  use material_law, only: material
  use matrix_guest, only: corner_guest
  use matrix_pattern, only: multiply
  use problem_definition, only: problem
  use run_ledger, only: ledger
  use step_plan, only: step, step_fixity
  use step_system, only: build_damping, build_inertia, build_structure, dam_system
  use testing, only: check, check_close, test_log
  implicit none
  type(test_log) :: log
  log%suite = 'step_damping'
  call compare(0.0_rk, 0, [0.0_rk, 0.0_rk], [0.0_rk, 0.0_rk], 'no damping')
  call compare(0.05_rk, 0, [0.0_rk, 0.0_rk], [0.0_rk, 0.0_rk], 'damping of the step')
  call compare(0.05_rk, 1, [0.0_rk, 0.0_rk], [0.0_rk, 0.0_rk], 'and of a guest')
  call compare(0.0_rk, 1, [0.0_rk, 0.0_rk], [0.0_rk, 0.0_rk], 'of a guest alone')
  call compare(0.0_rk, 0, [0.7_rk, 0.2_rk], [0.0_rk, 3.0e-3_rk], 'of two materials')
  call compare(0.03_rk, 1, [0.7_rk, 0.0_rk], [2.0e-3_rk, 0.0_rk], 'of all')
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Two blocks, a third of whose elements are of a second material.
  subroutine compare(ratio, num_guests, alpha, beta, what)
    real(rk), intent(in) :: ratio !< of the step
    integer, intent(in) :: num_guests
    real(rk), intent(in) :: alpha(2), beta(2) !< of the materials
    character(*), intent(in) :: what
    type(problem), target :: model
    type(step) :: plan
    type(dam_system) :: system
    type(ledger) :: costs
    type(error_type), allocatable :: error
    call make_model(num_guests, alpha, beta, model, plan)
    plan%damping%ratio = ratio
    plan%damping%f1 = 2.0_rk
    plan%damping%f2 = 9.0_rk
    call build_structure(model, plan, system, costs, error)
    call check(log,.not. allocated(error), what//': structure')
    call build_inertia(model, plan, system, costs, error)
    call build_damping(model, plan, system, costs, error)
    call check(log,.not. allocated(error), what//': damping')
    call check_products(model, plan, system, num_guests, what)
  end subroutine compare

  !> All ways to C agree with the sum over elements and guests. Tolerance: round-off of K.
  subroutine check_products(model, plan, system, num_guests, what)
    type(problem), intent(in) :: model
    type(step), intent(in) :: plan
    type(dam_system), intent(in) :: system
    integer, intent(in) :: num_guests
    character(*), intent(in) :: what
    type(error_type), allocatable :: error
    real(rk), allocatable :: c(:), values(:)
    real(rk), dimension(system%matrix%num_total) :: v, expected, force, elastic, inertia
    real(rk) :: many(system%matrix%num_free, 3), forces(system%matrix%num_free, 3)
    real(rk) :: alpha, beta, largest
    integer :: i
    alpha = 0.0_rk
    beta = 0.0_rk
    if (plan%damping%ratio > 0.0_rk) then
      call rayleigh_coefficients(plan%damping%ratio, plan%damping%f1, plan%damping%f2, alpha, beta)
    end if
    call assemble_damping(model, system%numbers, alpha, beta, system%matrix, c, error)
    c(1) = c(1) + 5.0e7_rk*num_guests
    allocate (values(size(c)), source=0.0_rk)
    call system%add_damping(2.0_rk, values)
    largest = max(1.0_rk, maxval(abs(c)))
    call check_close(log, maxval(abs(values - 2*c))/largest, 0.0_rk, 1.0e-13_rk, what//': values')
    v = [(sin(real(i, rk)), i=1, size(v))]
    call multiply(system%matrix, c, v, expected)
    call system%find_damping_force(v, force)
    call check_close(log, maxval(abs(force - expected))/largest, 0.0_rk, 1.0e-12_rk, what//': C v')
    call multiply(system%mass_pattern, system%mass_entries, v, inertia)
    call system%find_rate_forces(2*v, v, inertia, elastic, force)
    call check_close(log, maxval(abs(force - expected))/largest, 0.0_rk, 1.0e-12_rk, &
                     what//': with the elastic force')
    call system%find_elastic(2*v, force)
    call check_close(log, maxval(abs(force - elastic)), 0.0_rk, 1.0e-12_rk*maxval(abs(force)), &
                     what//': elastic force')
    many = spread(v(:system%matrix%num_free), 2, 3)
    v(system%matrix%num_free + 1:) = 0.0_rk ! prescribed unknowns are at rest there
    call multiply(system%matrix, c, v, expected)
    call system%find_damping_forces(many, forces)
    call check_close(log, maxval(abs(forces(:, 3) - expected(:size(forces, 1))))/largest, 0.0_rk, &
                     1.0e-12_rk, what//': many velocities')
  end subroutine check_products

  !> An arch of two blocks; every third element has the second material.
  subroutine make_model(num_guests, alpha, beta, model, plan)
    integer, intent(in) :: num_guests
    real(rk), intent(in) :: alpha(2), beta(2)
    type(problem), intent(out) :: model
    type(step), intent(out) :: plan
    type(material) :: materials(2)
    integer :: i
    call make_arch(1, 2, 3, 2, model, plan%fixities)
    do i = 1, 2
      materials(i) = model%materials(1)
      materials(i)%alpha = alpha(i)
      materials(i)%beta = beta(i)
    end do
    deallocate (materials(2)%law)
    allocate (materials(2)%law, source=elastic_law(young=12.0e9_rk, poisson=0.3_rk))
    materials(2)%density = 1900.0_rk
    model%materials = materials
    model%mesh%material_of_element(1::3) = 2
    allocate (plan%loads(0))
    if (num_guests == 0) return
    deallocate (model%guests)
    allocate (model%guests(1))
    allocate (model%guests(1)%item, source=corner_guest(name='corner', kind='spring'))
  end subroutine make_model
end program test_step_damping
