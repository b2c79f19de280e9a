!> Forces of solids whose stress is not a constant stiffness times strain: K u of the elastic solid
!> less the initial-stress force, here called excess (theory.md, (12.1)):
!>
!>   f = K u - excess,   excess = T^T sum w B^T (D eps - sigma)
!>
!> summed over the points that are not elastic. Threads update blocks of elements; forces are
!> summed in the order of the blocks, so that results do not depend on the number of threads.
module inelastic_forces
  use block_answers, only: block_answer, open_answers, share_failure
  use dam_mesh, only: element_is_there
  use kinds, only: rk
  use problem_definition, only: problem
  use node_dofs, only: add_vectors, gather_vectors
  use dof_numbering, only: numbering
  use inelastic_blocks, only: inelastic_block
  use gauss_rules, only: hex_point
  use shape_hex8, only: derivative_at, gradient_at, hex8_dofs
  use material_points, only: point_state, time_increment, no_tangent
  use ranks, only: is_first_rank
  use unknown_parts, only: unknown_part
  implicit none
  private
  public :: block_answer, open_answers, update_points, recall_points, sum_excess, find_failure
  public :: add_elements, has_many_elements, complete_energies

  !> Fewer elements than this are faster on one thread.
  integer, parameter :: few_elements = 32

contains

  !> Strains from displacements and stresses by the laws, for all blocks.
  subroutine update_points(model, u, origin, time, old, new, answers)
    type(problem), intent(in) :: model
    real(rk), intent(in) :: u(:, :) !< (3, nodes) at the end of the increment [m]
    real(rk), allocatable, intent(in) :: origin(:, :) !< (24, elements) without stress, if any [m]
    type(time_increment), intent(in) :: time
    type(point_state), intent(in) :: old(:) !< (blocks) converged
    type(point_state), intent(inout) :: new(:) !< (blocks)
    type(block_answer), intent(inout) :: answers(:) !< (blocks)
    integer :: i
    !$omp parallel do schedule(dynamic) default(none) if (has_many_elements(answers)) &
    !$omp shared(model, u, origin, time, old, new, answers)
    do i = 1, size(answers)
      if (model%materials(model%inelastic(i)%material)%law%is_serial) cycle
      call update_block(model, model%inelastic(i), u, origin, time, old(i), new(i), answers(i))
    end do
    !$omp end parallel do
    do i = 1, size(answers)
      if (.not. model%materials(model%inelastic(i)%material)%law%is_serial) cycle
      call update_block(model, model%inelastic(i), u, origin, time, old(i), new(i), answers(i))
    end do
  end subroutine update_points

  !> Energies at the strains of the last update, of laws that defer them.
  subroutine complete_energies(model, time, old, new, answers)
    type(problem), intent(in) :: model
    type(time_increment), intent(in) :: time !< wants_energy
    type(point_state), intent(in) :: old(:) !< (blocks) converged
    type(point_state), intent(inout) :: new(:) !< (blocks) updated
    type(block_answer), intent(inout) :: answers(:) !< (blocks)
    type(time_increment) :: moment
    integer :: i
    moment = time
    moment%is_updated = .true.
    !$omp parallel do schedule(dynamic) default(none) shared(model, moment, old, new, answers) &
    !$omp if (has_many_elements(answers))
    do i = 1, size(answers)
      if (.not. model%inelastic(i)%is_here()) cycle
      associate (law => model%materials(model%inelastic(i)%material)%law)
        if (.not. law%defers_energy .or. all(new(i)%is_elastic)) cycle
        call law%update(model%inelastic(i)%points, moment, old(i), new(i), answers(i)%tangent, &
                        answers(i)%report)
      end associate
    end do
    !$omp end parallel do
  end subroutine complete_energies

  !> Whether several threads are faster than one.
  pure logical function has_many_elements(answers)
    type(block_answer), intent(in) :: answers(:)
    integer :: i, num_elements
    num_elements = 0
    do i = 1, size(answers)
      num_elements = num_elements + size(answers(i)%has_excess)
    end do
    has_many_elements = num_elements > few_elements
  end function has_many_elements

  !> Answers of stored states, without calls of the laws and without tangents.
  subroutine recall_points(model, points, answers)
    type(problem), intent(in) :: model
    type(point_state), intent(in) :: points(:) !< (blocks)
    type(block_answer), intent(inout) :: answers(:) !< (blocks)
    integer :: i
    do i = 1, size(answers)
      answers(i)%takes_part(:) = .true.
      if (.not. model%inelastic(i)%is_here()) cycle
      if (element_is_there(model%mesh, model%inelastic(i)%elements(1))) then
        call sum_block(model%inelastic(i), points(i), answers(i))
      else
        call leave_out(answers(i))
      end if
    end do
  end subroutine recall_points

  !> Updates one block, unless it is that of another rank.
  subroutine update_block(model, part, u, origin, time, old, new, answer)
    type(problem), intent(in) :: model
    type(inelastic_block), intent(in) :: part
    real(rk), intent(in) :: u(:, :) !< (3, nodes) [m]
    real(rk), allocatable, intent(in) :: origin(:, :) !< (24, elements) without stress, if any [m]
    type(time_increment), intent(in) :: time
    type(point_state), intent(in) :: old
    type(point_state), intent(inout) :: new
    type(block_answer), intent(inout) :: answer
    integer :: num_tangents
    if (.not. (part%is_here() .and. any(answer%takes_part))) return
    num_tangents = merge(0, part%points%num_points, time%tangent == no_tangent)
    if (size(answer%tangent, 3) /= num_tangents) then
      deallocate (answer%tangent)
      allocate (answer%tangent(6, 6, num_tangents))
    end if
    if (.not. element_is_there(model%mesh, part%elements(1))) then ! all of the block are absent
      call leave_out(answer)
      return
    end if
    call move_points(model, part, u, origin, answer%takes_part, new)
    call call_law(model, part, time, old, new, answer)
    call sum_block(part, new, answer)
  end subroutine update_block

  !> An absent block has no forces, and its law gives no tangents, also where the law is never
  !> elastic (UMAT).
  pure subroutine leave_out(answer)
    type(block_answer), intent(inout) :: answer
    answer%has_excess = .false.
    answer%force = 0.0_rk
  end subroutine leave_out

  !> Calls the law of a block for the elements that take part.
  subroutine call_law(model, part, time, old, new, answer)
    type(problem), intent(in) :: model
    type(inelastic_block), intent(in) :: part
    type(time_increment), intent(in) :: time
    type(point_state), intent(in) :: old
    type(point_state), intent(inout) :: new
    type(block_answer), intent(inout) :: answer
    type(time_increment) :: moment
    moment = time
    if (size(answer%tangent, 3) == 0 .and. .not. all(answer%takes_part)) then
      moment%stays = reshape(spread(.not. answer%takes_part, 1, part%points_of_element), &
                             [part%points%num_points])
    end if
    associate (law => model%materials(part%material)%law)
      call law%update(part%points, moment, old, new, answer%tangent, answer%report)
    end associate
  end subroutine call_law

  !> Strains, and gradients where the law wants them, of the elements that take part.
  subroutine move_points(model, part, u, origin, takes_part, new)
    type(problem), intent(in) :: model
    type(inelastic_block), intent(in) :: part
    real(rk), intent(in) :: u(:, :) !< (3, nodes) [m]
    real(rk), allocatable, intent(in) :: origin(:, :) !< (24, elements) without stress, if any [m]
    logical, intent(in) :: takes_part(:) !< (elements)
    type(point_state), intent(inout) :: new
    real(rk) :: moved(hex8_dofs)
    integer :: e, first, last
    do e = 1, size(part%elements)
      if (.not. takes_part(e)) cycle
      moved = gather_vectors(u, model%mesh%nodes(:, part%elements(e)))
      if (allocated(origin)) moved = moved - origin(:, part%elements(e))
      last = e*part%points_of_element
      first = last - part%points_of_element + 1
      call part%find_strains(e, moved, new%strain(:, first:last))
      if (size(new%gradient, 3) > 0) then
        call find_gradients(model%mesh%x(:, model%mesh%nodes(:, part%elements(e))), moved, &
                            new%strain(:, first:last), new%gradient(:, :, first:last))
      end if
      if (allocated(new%thermal)) then
        new%strain(:, first:last) = new%strain(:, first:last) - new%thermal(:, first:last)
      end if
    end do
  end subroutine move_points

  !> du_i/dx_j of an element: rotation from the shape functions, strain from the element.
  subroutine find_gradients(x, moved, strain, gradient)
    real(rk), intent(in) :: x(3, 8), moved(hex8_dofs) !< of the nodes [m]
    real(rk), intent(in) :: strain(:, :) !< (6, points)
    real(rk), intent(out) :: gradient(:, :, :) !< (3, 3, points)
    real(rk) :: slope(3, 8), plain(3, 3), xi(3), determinant
    integer :: q
    do q = 1, size(strain, 2)
      xi = 0.0_rk
      if (size(strain, 2) > 1) xi = hex_point(:, q)
      call gradient_at(x, derivative_at(xi), slope, determinant)
      plain = matmul(reshape(moved, [3, 8]), transpose(slope))
      gradient(:, :, q) = 0.5_rk*(plain - transpose(plain)) + tensor_of(strain(:, q))
    end do
  end subroutine find_gradients

  !> The symmetric tensor of a strain in Voigt's order.
  pure function tensor_of(strain) result(tensor)
    real(rk), intent(in) :: strain(6)
    real(rk) :: tensor(3, 3)
    associate (s => strain, h => 0.5_rk*strain)
      tensor = reshape([s(1), h(4), h(5), h(4), s(2), h(6), h(5), h(6), s(3)], [3, 3])
    end associate
  end function tensor_of

  !> sum w B^T (D eps - sigma) of each element that takes part.
  pure subroutine sum_block(part, new, answer)
    type(inelastic_block), intent(in) :: part
    type(point_state), intent(in) :: new
    type(block_answer), intent(inout) :: answer
    real(rk) :: excess(part%points_of_element, 6)
    integer :: e, q, p
    do e = 1, size(part%elements)
      if (.not. answer%takes_part(e)) cycle
      answer%has_excess(e) = .false.
      answer%force(:, e) = 0.0_rk
      p = (e - 1)*part%points_of_element
      if (all(new%is_elastic(p + 1:p + part%points_of_element))) cycle
      excess = 0.0_rk
      do q = 1, part%points_of_element
        p = (e - 1)*part%points_of_element + q
        if (new%is_elastic(p)) cycle
        answer%has_excess(e) = .true.
        excess(q, :) = part%weight(q, e)*(matmul(part%d, new%strain(:, p)) - new%stress(:, p))
      end do
      call part%add_forces(e, excess, answer%force(:, e))
    end do
  end subroutine sum_block

  !> Initial-stress force of all blocks and of other guests in the unknowns of a step.
  subroutine sum_excess(model, numbers, part, answers, of_guests, excess)
    type(problem), intent(in) :: model
    type(numbering), intent(in) :: numbers
    type(unknown_part), intent(in) :: part
    type(block_answer), intent(in) :: answers(:)
    real(rk), intent(in) :: of_guests(:, :) !< (3, nodes) [N]
    real(rk), contiguous, intent(out) :: excess(:) !< (num_total) [N]
    real(rk), allocatable :: nodal(:, :)
    integer :: i
    nodal = of_guests
    if (.not. is_first_rank()) nodal = 0.0_rk
    do i = 1, size(answers)
      call add_elements(model, i, answers(i)%force, answers(i)%has_excess, nodal)
    end do
    call numbers%reduce(nodal, excess)
    call part%add(excess)
  end subroutine sum_excess

  !> Adds forces of the elements of a block at their nodes.
  pure subroutine add_elements(model, block, force, has_force, nodal)
    type(problem), intent(in) :: model
    integer, intent(in) :: block
    real(rk), intent(in) :: force(:, :) !< (24, elements) [N]
    logical, intent(in) :: has_force(:) !< (elements) the others are left out
    real(rk), intent(inout) :: nodal(:, :) !< (3, nodes) [N]
    integer :: e
    associate (elements => model%inelastic(block)%elements)
      do e = 1, size(elements)
        if (has_force(e)) call add_vectors(force(:, e), model%mesh%nodes(:, elements(e)), nodal)
      end do
    end associate
  end subroutine add_elements

  !> Smallest increment that a law requests, and the reason with element and point.
  subroutine find_failure(model, answers, size_ratio, why)
    type(problem), intent(in) :: model
    type(block_answer), intent(in) :: answers(:)
    real(rk), intent(out) :: size_ratio !< requested over present size; 1: no request
    character(:), allocatable, intent(out) :: why !< of all ranks; unallocated without a request
    character(80) :: place
    integer :: i, first
    size_ratio = 1.0_rk
    first = size(answers) + 1
    do i = 1, size(answers)
      associate (report => answers(i)%report, part => model%inelastic(i))
        size_ratio = min(size_ratio, report%size_ratio)
        if (allocated(why) .or. (report%failed_point == 0 .and. report%size_ratio >= 1.0_rk)) cycle
        first = i
        why = 'the law requests a smaller increment'
        if (allocated(report%message)) why = report%message
        place = ''
        if (report%failed_point > 0) then
          write (place, '(a,i0,a,i0)') ', element ', part%points%element(report%failed_point), &
            ', point ', part%points%number(report%failed_point)
        end if
        why = 'material '//model%materials(part%material)%name//trim(place)//': '//why
      end associate
    end do
    call share_failure(size(answers), first, size_ratio, why)
  end subroutine find_failure
end module inelastic_forces
