!> The thermal force of the solids: sum of w B^T D times the thermal strain, and its energy. A rank
!> has those of its elements.
!>
!> Threads take pieces of the list of elements; forces and energies are summed in the order of the
!> elements, so that sums do not depend on the number of threads.
module assemble_heat
  use dam_mesh, only: is_assembled_here
  use dof_numbering, only: numbering
  use element_catalogue, only: make_solid
  use element_formulation, only: solid_element
  use element_matrices, only: stress_forces
  use kinds, only: rk
  use node_dofs, only: add_vectors, zero_vectors
  use problem_definition, only: problem
  use ranks, only: this_rank
  use shape_hex8, only: hex8_dofs
  use thermal_strains, only: expands, find_thermal_strains, heat_field
  implicit none
  private
  public :: assemble_thermal_force

  integer, parameter :: largest_piece = 32 !< elements; their operators fit the cache of a core

  !> Forces and energies of all elements.
  type :: element_answers
    real(rk), allocatable :: force(:, :) !< (24, elements) [N]
    real(rk), allocatable :: energy(:) !< (elements) [J]
  end type element_answers

contains

  !> The force, and the energy 1/2 e D e + u_0 f of elements that are held at their origins u_0.
  subroutine assemble_thermal_force(model, numbers, heat, origin, force, energy)
    type(problem), intent(in) :: model
    type(numbering), intent(in) :: numbers
    type(heat_field), intent(in) :: heat !< with reference temperatures
    real(rk), allocatable, intent(in) :: origin(:, :) !< (24, elements) u_0, if any [m]
    real(rk), intent(out) :: force(:) !< (num_total) [N]
    real(rk), intent(out) :: energy !< [J]
    type(element_answers) :: answers
    real(rk), allocatable :: nodal(:, :)
    integer, allocatable :: elements(:), first(:)
    integer :: e, i
    elements = pack([(e, e=1, model%mesh%num_elements)], &
                    [(is_assembled_here(model%mesh, this_rank(), e) .and. expands(model, e), &
                      e=1, model%mesh%num_elements)])
    call cut_pieces(model, elements, first)
    allocate (answers%force(hex8_dofs, size(elements)), answers%energy(size(elements)))
    !$omp parallel do schedule(dynamic) default(none) shared(model, heat, elements, first, answers)
    do i = 1, size(first) - 1
      call integrate_piece(model, heat, elements, first(i), first(i + 1) - 1, answers)
    end do
    !$omp end parallel do
    nodal = zero_vectors(model%mesh%num_nodes)
    energy = 0.0_rk
    do i = 1, size(elements)
      e = elements(i)
      energy = energy + answers%energy(i)
      if (allocated(origin)) energy = energy + dot_product(origin(:, e), answers%force(:, i))
      call add_vectors(answers%force(:, i), model%mesh%nodes(:, e), nodal)
    end do
    call numbers%reduce(nodal, force)
  end subroutine assemble_thermal_force

  !> Cuts the list into pieces of one kind and one material.
  pure subroutine cut_pieces(model, elements, first)
    type(problem), intent(in) :: model
    integer, intent(in) :: elements(:) !< positions
    integer, allocatable, intent(out) :: first(:) !< (pieces + 1) positions in the list
    integer :: i, used
    logical :: is_new
    allocate (first(size(elements) + 1))
    used = 0
    do i = 1, size(elements)
      is_new = used == 0
      if (.not. is_new) then
        associate (mesh => model%mesh, last => elements(i - 1), this => elements(i))
          is_new = i - first(used) >= largest_piece .or. &
                   mesh%element_type(this) /= mesh%element_type(last) .or. &
                   mesh%material_of_element(this) /= mesh%material_of_element(last)
        end associate
      end if
      if (.not. is_new) cycle
      used = used + 1
      first(used) = i
    end do
    first(used + 1) = size(elements) + 1
    first = first(:used + 1)
  end subroutine cut_pieces

  !> Forces and energies of one piece.
  subroutine integrate_piece(model, heat, elements, first, last, answers)
    type(problem), intent(in) :: model
    type(heat_field), intent(in) :: heat
    integer, intent(in) :: elements(:) !< positions
    integer, intent(in) :: first, last !< of the list
    type(element_answers), intent(inout) :: answers
    class(solid_element), allocatable :: formulation
    real(rk), allocatable :: b(:, :, :, :), weight(:, :), x(:, :, :), expansion(:, :)
    real(rk), allocatable :: strain(:, :, :), stress(:, :, :), force(:, :)
    integer :: status(last - first + 1), e, q, n, points
    real(rk) :: d(6, 6)
    n = last - first + 1
    call make_solid(model%mesh%element_type(elements(first)), formulation)
    call model%materials(model%mesh%material_of_element(elements(first)))%law%elastic_stiffness(d)
    points = formulation%num_points
    allocate (b(6, hex8_dofs, points, n), weight(points, n), x(3, 8, n), expansion(points, n), &
              strain(6, points, n), stress(6, points, n), force(hex8_dofs, n))
    do e = 1, n
      x(:, :, e) = model%mesh%x(:, model%mesh%nodes(:, elements(first + e - 1)))
    end do
    call formulation%strain_operator(x, d, b, weight, status)
    call find_thermal_strains(model, heat, elements(first:last), expansion, strain)
    do e = 1, n
      do q = 1, points
        stress(:, q, e) = matmul(d, strain(:, q, e))
      end do
      answers%energy(first + e - 1) = 0.5_rk*sum(weight(:, e)*sum(strain(:, :, e) &
                                                                  *stress(:, :, e), 1))
    end do
    call stress_forces(b, weight, stress, force)
    answers%force(:, first:last) = force
  end subroutine integrate_piece
end module assemble_heat
