!> Sums the matrices of the solid elements: stiffness, mass and damping.
!>
!> Threads take blocks of elements of one colour at a time, so that sums do not depend on the number
!> of threads.
module assemble_elements
  use kinds, only: rk
  use errors, only: error_type, raise
  use problem_definition, only: problem
  use node_dofs, only: add_vectors, num_directions, zero_vectors
  use dof_numbering, only: numbering
  use matrix_pattern, only: pattern
  use element_formulation, only: solid_element
  use element_catalogue, only: make_solid
  use element_matrices, only: stiffness_matrices, consistent_masses, nodal_volumes
  use shape_hex8, only: hex8_dofs
  use element_blocks, only: block_list, list_blocks
  use scatter_matrix, only: scatter_nodes
  implicit none
  private
  public :: assemble_stiffness, assemble_mass, assemble_damping, assemble_origins

contains

  !> K of the elements, elastic, without joints.
  subroutine assemble_stiffness(model, numbers, matrix, values, error)
    type(problem), intent(in) :: model
    type(numbering), intent(in) :: numbers
    type(pattern), intent(in) :: matrix
    real(rk), allocatable, intent(out) :: values(:) !< [N/m]
    type(error_type), allocatable, intent(out) :: error
    real(rk) :: one(size(model%materials)), zero(size(model%materials))
    one = 1.0_rk
    zero = 0.0_rk
    call sum_elements(model, numbers, one, zero, matrix, values, error)
  end subroutine assemble_stiffness

  !> M of the elements, consistent or lumped, without added mass.
  subroutine assemble_mass(model, numbers, matrix, values, error)
    type(problem), intent(in) :: model
    type(numbering), intent(in) :: numbers
    type(pattern), intent(in) :: matrix
    real(rk), allocatable, intent(out) :: values(:) !< [kg]
    type(error_type), allocatable, intent(out) :: error
    real(rk) :: zero(size(model%materials))
    zero = 0.0_rk
    call sum_elements(model, numbers, zero, model%materials%density, matrix, values, error)
  end subroutine assemble_mass

  !> C = sum of alpha M + beta K of the elements: Rayleigh damping of the materials plus that of the
  !> step.
  subroutine assemble_damping(model, numbers, alpha, beta, matrix, values, error)
    type(problem), intent(in) :: model
    type(numbering), intent(in) :: numbers
    real(rk), intent(in) :: alpha, beta !< of the step [1/s], [s]
    type(pattern), intent(in) :: matrix
    real(rk), allocatable, intent(out) :: values(:) !< [N s/m]
    type(error_type), allocatable, intent(out) :: error
    call sum_elements(model, numbers, model%materials%beta + beta, &
                      (model%materials%alpha + alpha)*model%materials%density, matrix, values, &
                      error)
  end subroutine assemble_damping

  !> Sum of K_e u_0 over the elements, and of their energies at u_0.
  subroutine assemble_origins(model, numbers, origin, force, energy, error)
    type(problem), intent(in) :: model
    type(numbering), intent(in) :: numbers
    real(rk), intent(in) :: origin(:, :) !< (24, elements) u_0 [m]
    real(rk), intent(out) :: force(:) !< (num_total) [N]
    real(rk), intent(out) :: energy !< [J]
    type(error_type), allocatable, intent(out) :: error
    type(block_list) :: blocks
    real(rk) :: one(size(model%materials)), zero(size(model%materials)), own(hex8_dofs)
    real(rk), allocatable :: ke(:, :, :), nodal(:, :)
    integer :: i, k, bad(2)
    one = 1.0_rk
    zero = 0.0_rk
    energy = 0.0_rk
    bad = 0
    nodal = zero_vectors(model%mesh%num_nodes)
    call list_blocks(model, numbers, blocks)
    do i = 1, blocks%num_blocks
      associate (elements => blocks%element(blocks%first(i):blocks%first(i + 1) - 1))
        if (.not. any(abs(origin(:, elements)) > 0.0_rk)) cycle
        call integrate_block(model, elements, one, zero, ke, bad)
        do k = 1, size(elements)
          own = matmul(ke(:, :, k), origin(:, elements(k)))
          energy = energy + 0.5_rk*dot_product(origin(:, elements(k)), own)
          call add_vectors(own, model%mesh%nodes(:, elements(k)), nodal)
        end do
      end associate
    end do
    call numbers%reduce(nodal, force)
    if (bad(1) > 0) call report_jacobian(model%mesh%element_id(bad(1)), bad(2), error)
  end subroutine assemble_origins

  !> Sum of stiffness*K_e + density*M_e (M_e of unit density).
  subroutine sum_elements(model, numbers, stiffness, density, matrix, values, error)
    type(problem), intent(in) :: model
    type(numbering), intent(in) :: numbers
    real(rk), intent(in) :: stiffness(:), density(:) !< (materials)
    type(pattern), intent(in) :: matrix
    real(rk), allocatable, intent(out) :: values(:)
    type(error_type), allocatable, intent(out) :: error
    type(block_list) :: blocks
    integer :: colour, i, bad(2)
    logical :: is_parallel
    allocate (values(size(matrix%row)))
    values = 0.0_rk
    bad = 0
    call list_blocks(model, numbers, blocks)
    do colour = 1, blocks%num_colours
      is_parallel = colour < blocks%num_colours .or. .not. blocks%last_is_serial
      !$omp parallel do schedule(dynamic) default(none) if (is_parallel) &
      !$omp shared(model, numbers, stiffness, density, matrix, values, blocks, colour, bad)
      do i = blocks%first_block(colour), blocks%first_block(colour + 1) - 1
        call add_elements(model, numbers, blocks%element(blocks%first(i):blocks%first(i + 1) - 1), &
                          stiffness, density, matrix, values, bad)
      end do
      !$omp end parallel do
    end do
    if (bad(1) > 0) call report_jacobian(model%mesh%element_id(bad(1)), bad(2), error)
  end subroutine sum_elements

  !> Adds the matrices of one block.
  subroutine add_elements(model, numbers, elements, stiffness, density, matrix, values, bad)
    type(problem), intent(in) :: model
    type(numbering), intent(in) :: numbers
    integer, intent(in) :: elements(:)
    real(rk), intent(in) :: stiffness(:), density(:) !< (materials)
    type(pattern), intent(in) :: matrix
    real(rk), intent(inout) :: values(:)
    integer, intent(inout) :: bad(2) !< element and corner, shared by the threads
    real(rk), allocatable :: ke(:, :, :)
    integer :: e
    call integrate_block(model, elements, stiffness, density, ke, bad)
    do e = 1, size(elements)
      call scatter_nodes(numbers, model%mesh%nodes(:, elements(e)), ke(:, :, e), matrix, values)
    end do
  end subroutine add_elements

  !> The matrices of a block; names an element whose Jacobian is not positive.
  subroutine integrate_block(model, elements, stiffness, density, ke, bad)
    type(problem), intent(in) :: model
    integer, intent(in) :: elements(:) !< of one kind and one material
    real(rk), intent(in) :: stiffness(:), density(:) !< (materials)
    real(rk), allocatable, intent(out) :: ke(:, :, :) !< (24, 24, elements)
    integer, intent(inout) :: bad(2) !< element and corner, shared by the threads
    class(solid_element), allocatable :: element
    real(rk), allocatable :: x(:, :, :)
    real(rk) :: d(6, 6)
    integer :: status(size(elements)), e, material
    material = model%mesh%material_of_element(elements(1))
    allocate (x(3, 8, size(elements)), ke(hex8_dofs, hex8_dofs, size(elements)))
    do e = 1, size(elements)
      x(:, :, e) = model%mesh%x(:, model%mesh%nodes(:, elements(e)))
    end do
    if (abs(stiffness(material)) > 0.0_rk) then
      call make_solid(model%mesh%element_type(elements(1)), element)
      call model%materials(material)%law%elastic_stiffness(d)
      call stiffness_matrices(element, x, d, ke, status)
      ke = stiffness(material)*ke ! d is positive definite, its multiple need not be
      if (any(status /= 0)) then
        e = findloc(status /= 0, .true., 1)
        !$omp critical
        if (bad(1) == 0 .or. elements(e) < bad(1)) bad = [elements(e), status(e)]
        !$omp end critical
      end if
    else
      ke = 0.0_rk
    end if
    if (abs(density(material)) > 0.0_rk) then
      call add_masses(x, density(material), model%has_lumped_mass, ke)
    end if
  end subroutine integrate_block

  !> Adds the masses of a block, the same in the three directions.
  subroutine add_masses(x, density, is_lumped, ke)
    real(rk), contiguous, intent(in) :: x(:, :, :)
    real(rk), intent(in) :: density
    logical, intent(in) :: is_lumped
    real(rk), intent(inout) :: ke(:, :, :)
    real(rk), allocatable :: mass(:, :, :), volume(:, :)
    integer :: e, a, i
    allocate (mass(8, 8, size(x, 3)))
    if (is_lumped) then
      allocate (volume(8, size(x, 3)))
      call nodal_volumes(x, volume)
      mass = 0.0_rk
      do a = 1, 8
        mass(a, a, :) = density*volume(a, :)
      end do
    else
      call consistent_masses(x, density, mass)
    end if
    do e = 1, size(x, 3)
      do i = 1, num_directions
        associate (part => ke(i::num_directions, i::num_directions, e))
          part = part + mass(:, :, e)
        end associate
      end do
    end do
  end subroutine add_masses

  !> Names an element by the user's number.
  subroutine report_jacobian(element_id, corner, error)
    integer, intent(in) :: element_id, corner
    type(error_type), allocatable, intent(out) :: error
    character(80) :: message
    write (message, '(a,i0,a,i0)') 'element ', element_id, &
      ': Jacobian not positive at corner ', corner
    call raise(error, trim(message))
  end subroutine report_jacobian
end module assemble_elements
