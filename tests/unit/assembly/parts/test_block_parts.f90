!> Blocks of inelastic elements: their strain operators in all kinds of elements, and their division
!> among ranks.
program test_block_parts
  use block_parts, only: choose_ranks, elements_here
  use arch_model, only: make_arch
  use hand_law, only: by_hand
  use inelastic_blocks, only: inelastic_block, list_inelastic_blocks
  use kinds, only: rk
  use problem_definition, only: problem
  use step_plan, only: step_fixity
  use testing, only: test_log, check, check_close, repeat_chance
  implicit none

  character(8), parameter :: kinds_of_solids(4) = ['C3D8    ', 'C3D8B   ', 'C3D8I   ', 'C3D8R   ']
  type(test_log) :: log
  type(problem) :: model
  integer, parameter :: num_parts = 3

  log%suite = 'block_parts'
  call repeat_chance(1)
  call make_model()
  call operators_give_the_strains(log)
  call ranks_have_what_is_theirs(log)
  call ranks_have_equal_shares(log)
  call forgotten_points_leave_the_elements(log)
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Elements of all kinds with a law that has a history.
  subroutine make_model()
    type(step_fixity), allocatable :: fixities(:)
    type(by_hand) :: law
    integer :: e
    call make_arch(2, 3, 6, 2, model, fixities)
    law%num_state = 8
    law%is_nonlinear = .true.
    deallocate (model%materials)
    allocate (model%materials(1))
    model%materials(1)%law = law
    associate (m => model%mesh)
      do e = 1, m%num_elements
        m%element_type(e) = kinds_of_solids(1 + mod(e, 4))
      end do
      m%material_of_element = 1
      m%section_of_element = 1
    end associate
    call list_inelastic_blocks(model%mesh, model%materials, model%inelastic)
  end subroutine make_model

  !> B u at a point is the strain there, with slopes and with operators.
  subroutine operators_give_the_strains(log)
    type(test_log), intent(inout) :: log
    real(rk) :: b(6, 24), u(24)
    real(rk), allocatable :: strain(:, :)
    integer :: i, q
    logical :: has_slopes(2)
    has_slopes = .false.
    call random_number(u)
    do i = 1, size(model%inelastic)
      associate (part => model%inelastic(i))
        has_slopes(merge(1, 2, allocated(part%slope))) = .true.
        call check(log, allocated(part%slope) .neqv. allocated(part%b), 'slopes or operators')
        allocate (strain(6, part%points_of_element))
        call part%find_strains(1, u, strain)
        do q = 1, part%points_of_element
          call part%find_operator(1, q, b)
          call check_close(log, maxval(abs(matmul(b, u) - strain(:, q))), 0.0_rk, &
                           1.0e-13_rk*maxval(abs(strain)), 'strain of the operator') ! round-off
        end do
        deallocate (strain)
      end associate
    end do
    call check(log, all(has_slopes), 'elements with slopes and with operators')
  end subroutine operators_give_the_strains

  !> Blocks whose elements have one rank go to that rank, where the shares allow it.
  subroutine ranks_have_what_is_theirs(log)
    type(test_log), intent(inout) :: log
    type(inelastic_block), allocatable :: blocks(:)
    integer :: owner(model%mesh%num_elements), i
    blocks = [model%inelastic, model%inelastic]
    do i = 1, size(blocks)
      blocks(i)%elements = [i]
      owner(i) = mod(7*i, num_parts)
    end do
    call choose_ranks(owner, num_parts, blocks)
    do i = 1, size(blocks)
      call check(log, blocks(i)%rank == mod(7*i, num_parts), 'the rank of the element')
    end do
  end subroutine ranks_have_what_is_theirs

  !> Where one rank has all elements, the blocks are shared all the same.
  subroutine ranks_have_equal_shares(log)
    type(test_log), intent(inout) :: log
    type(inelastic_block), allocatable :: blocks(:)
    integer :: owner(model%mesh%num_elements), part, num(0:num_parts - 1)
    blocks = [model%inelastic, model%inelastic]
    owner = 1
    call choose_ranks(owner, num_parts, blocks)
    do part = 0, num_parts - 1
      num(part) = count(blocks%rank == part)
    end do
    call check(log, maxval(num) - minval(num) <= 1, 'equal numbers of blocks')
    call check(log, sum(num) == size(blocks), 'each block has a rank')
  end subroutine ranks_have_equal_shares

  !> A block of another rank keeps its elements, but no tables of points.
  subroutine forgotten_points_leave_the_elements(log)
    type(test_log), intent(inout) :: log
    type(inelastic_block), allocatable :: blocks(:)
    integer :: num_points
    blocks = model%inelastic
    num_points = blocks(1)%num_points()
    blocks(1)%rank = 1
    call blocks(1)%forget_points()
    call check(log, blocks(1)%num_points() == num_points, 'number of points of all ranks')
    call check(log, size(blocks(1)%points%x) == 0 .and. size(blocks(1)%weight) == 0, 'no tables')
    call check(log, size(elements_here(blocks)) + size(blocks(1)%elements) &
               == model%mesh%num_elements, 'elements of this rank')
  end subroutine forgotten_points_leave_the_elements
end program test_block_parts
