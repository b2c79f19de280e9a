!> Stress, damage and state variables of inelastic solids at points and nodes, from histories set by
!> hand: an arch of four kinds of solids, its upper part of a law with a history.
program test_law_fields
  use kinds, only: rk
  use problem_definition, only: problem
  use analysis_state, only: state
  use step_plan, only: step_fixity
  use material_law, only: start_points
  use inelastic_blocks, only: list_inelastic_blocks
  use law_fields, only: width_of_field, field_at_points
  use stress_fields, only: recovered_fields
  use arch_model, only: make_arch
  use hand_law, only: by_hand, set_elastic
  use testing, only: check, check_close, repeat_chance, test_log
  implicit none
  character(8), parameter :: kinds_of_solids(4) = ['C3D8    ', 'C3D8B   ', 'C3D8I   ', 'C3D8R   ']
  type(test_log) :: log
  type(problem) :: model
  type(state) :: now
  log%suite = 'law_fields'
  call repeat_chance(1)
  call make_model()
  call test_widths(log)
  call test_elastic_points(log)
  call test_cracked_points(log)
  call test_freed_points(log)
  print '(i0,a,i0,a)', log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Section 2, the upper half, has the law with a history.
  subroutine make_model()
    type(step_fixity), allocatable :: fixities(:)
    type(by_hand) :: law
    type(problem) :: arch
    real(rk) :: height
    integer :: e, i
    call make_arch(2, 3, 6, 2, arch, fixities)
    allocate (model%materials(2))
    model%materials(1)%law = arch%materials(1)%law
    law%num_state = 8
    law%is_nonlinear = .true.
    model%materials(2)%law = law
    model%mesh = arch%mesh
    allocate (model%joints(0), model%loads(0), model%guests(0))
    associate (m => model%mesh)
      do e = 1, m%num_elements
        m%element_type(e) = kinds_of_solids(1 + mod(e, 4))
        height = sum(m%x(3, m%nodes(:, e)))/8.0_rk
        m%section_of_element(e) = merge(2, 1, height > 0.5_rk*maxval(m%x(3, :)))
      end do
      m%material_of_element = m%section_of_element
    end associate
    call list_inelastic_blocks(model%mesh, model%materials, model%inelastic)
    allocate (now%u(3, model%mesh%num_nodes), now%points(size(model%inelastic)))
    call random_number(now%u)
    now%u = 1.0e-3_rk*now%u
    do i = 1, size(model%inelastic)
      call start_points(law, model%inelastic(i)%points, now%points(i))
    end do
    call set_elastic(model, now)
  end subroutine make_model

  !> Components of the law with most; none for a field that nobody has.
  subroutine test_widths(log)
    type(test_log), intent(inout) :: log
    type(problem) :: other
    call check(log, width_of_field(model, 'DAMAGET') == 1, 'damage is one number')
    call check(log, width_of_field(model, 'PE') == 6, 'plastic strain is a tensor')
    call check(log, width_of_field(model, 'SDV') == 8, 'all state variables')
    call check(log, width_of_field(model, 'TEMP') == 0, 'an unknown field')
    call check(log, width_of_field(other, 'PE') == 0, 'no inelastic solids')
  end subroutine test_widths

  !> Points that are still elastic: the stress is that of an elastic model, by points and operator.
  subroutine test_elastic_points(log)
    type(test_log), intent(inout) :: log
    type(problem) :: elastic
    real(rk) :: expected(6, model%mesh%num_nodes), found(6, model%mesh%num_nodes)
    elastic = model
    deallocate (elastic%inelastic)
    call stress_on_nodes(elastic, 1, expected)
    call stress_on_nodes(model, 1, found)
    ! Sums of 24 products in another order.
    call check_close(log, maxval(abs(found - expected))/maxval(abs(expected)), 0.0_rk, 1.0e-13_rk, &
                     'elastic points')
    call stress_on_nodes(model, 5, found)
    call check_close(log, maxval(abs(found - expected))/maxval(abs(expected)), 0.0_rk, 1.0e-13_rk, &
                     'elastic points by the operator')
  end subroutine test_elastic_points

  !> Some points are cracked: nothing on the nodes goes beyond the points around them.
  subroutine test_cracked_points(log)
    type(test_log), intent(inout) :: log
    type(recovered_fields) :: fields
    real(rk) :: by_points(6, model%mesh%num_nodes), by_operator(6, model%mesh%num_nodes)
    real(rk) :: before(6, model%mesh%num_nodes)
    real(rk), allocatable :: damage(:, :), at_points(:, :, :)
    logical :: is_touched(model%mesh%num_nodes)
    call stress_on_nodes(model, 1, before)
    call crack(is_touched)
    call stress_on_nodes(model, 1, by_points)
    call stress_on_nodes(model, 5, by_operator)
    call check_close(log, maxval(abs(by_points - by_operator))/maxval(abs(by_points)), 0.0_rk, &
                     1.0e-13_rk, 'points and operator agree')
    call check(log, maxval(abs(by_points - before), mask=spread(.not. is_touched, 1, 6)) <= &
               1.0e-13_rk*maxval(abs(before)), 'nodes away from the crack are as before')
    call check_near_points(log, by_points)
    call fields%field_on_nodes(model, now, 'DAMAGET', damage)
    call field_at_points(model, fields%plan, now, 'DAMAGET', at_points)
    call check_close(log, maxval(damage), 1.0_rk, 0.0_rk, 'largest damage')
    call check_close(log, minval(damage), 0.0_rk, 0.0_rk, 'smallest damage')
    call check_close(log, maxval(at_points), 1.0_rk, 0.0_rk, 'largest damage at points')
    call fields%field_on_nodes(model, now, 'PE', damage)
    call check(log, size(damage, 1) == 6, 'plastic strain on nodes')
    call check_close(log, maxval(damage(2, :)), 2.0e-3_rk, 1.0e-18_rk, 'plastic strain')
  end subroutine test_cracked_points

  !> All points of an element of each kind crack, of C3D8I only the first. The last element of the
  !> mesh, a C3D8, is among them.
  subroutine crack(is_touched)
    logical, intent(out) :: is_touched(:) !< (nodes)
    integer :: i, e, n, first, last
    is_touched = .false.
    do i = 1, size(model%inelastic)
      n = model%inelastic(i)%points_of_element
      associate (points => now%points(i), elements => model%inelastic(i)%elements)
        last = merge(1, n, model%inelastic(i)%kind == 'C3D8I')
        e = size(elements)
        first = (e - 1)*n + 1
        points%is_elastic(first:first + last - 1) = .false.
        points%stress(:, first:first + last - 1) = 0.0_rk
        points%internal(1, first:first + last - 1) = 1.0_rk
        points%internal(4, first:first + last - 1) = 2.0e-3_rk
        is_touched(model%mesh%nodes(:, elements(e))) = .true.
      end associate
    end do
  end subroutine crack

  !> A corner of a cracked element that no other element shares has the nearest point's stress: 0.
  subroutine check_near_points(log, stress)
    type(test_log), intent(inout) :: log
    real(rk), intent(in) :: stress(:, :)
    integer :: uses(model%mesh%num_nodes), e, a, node, seen
    uses = 0
    do e = 1, model%mesh%num_elements
      uses(model%mesh%nodes(:, e)) = uses(model%mesh%nodes(:, e)) + 1
    end do
    e = model%mesh%num_elements
    seen = 0
    do a = 1, 8
      node = model%mesh%nodes(a, e)
      if (uses(node) > 1) cycle
      seen = seen + 1
      call check_close(log, maxval(abs(stress(:, node))), 0.0_rk, 0.0_rk, 'stress of a free corner')
    end do
    call check(log, seen > 0, 'the last element has a free corner')
  end subroutine check_near_points

  !> Stresses at points that one increment alone has used do not stay in memory; those that two
  !> increments in a row have used do.
  subroutine test_freed_points(log)
    type(test_log), intent(inout) :: log
    type(recovered_fields) :: fields
    real(rk), allocatable :: first(:, :, :)
    integer :: i
    do i = 1, 3
      call fields%invalidate()
      call fields%need_points(model, now)
      call check(log,.not. allocated(fields%point_strain), 'stresses need no strains in memory')
      if (i == 1) first = fields%point_stress
      call check_close(log, maxval(abs(fields%point_stress - first)), 0.0_rk, 0.0_rk, &
                       'the same stresses after they were freed')
      call fields%free_points()
      call check(log, allocated(fields%point_stress) .eqv. i > 1, 'stresses stay where they pay')
    end do
    call fields%invalidate()
    call fields%free_points()
    call check(log,.not. allocated(fields%point_stress), 'stresses without use are freed')
  end subroutine test_freed_points

  !> The stress of the `times`-th request in a run; the third request makes the operator.
  subroutine stress_on_nodes(body, times, stress)
    type(problem), intent(in) :: body
    integer, intent(in) :: times
    real(rk), intent(out) :: stress(:, :)
    type(recovered_fields) :: fields
    integer :: i
    do i = 1, times
      call fields%invalidate()
      call fields%need_node_stress(body, now)
    end do
    call check(log, fields%has_operator .eqv. times > 3, 'the operator is made when it pays')
    stress = fields%node_stress
  end subroutine stress_on_nodes
end program test_law_fields
