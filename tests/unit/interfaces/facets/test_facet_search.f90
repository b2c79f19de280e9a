!> The tree of boxes finds what comparing all boxes finds.
program test_facet_search
  use facet_search, only: box_tree, build_tree, find_boxes
  use kinds, only: rk
  use testing, only: check, test_log
  implicit none
  type(test_log) :: log
  integer :: num

  log%suite = 'facet_search'
  do num = 1, 40
    call compare(log, num, 0.1_rk)
  end do
  call compare(log, 500, 0.1_rk)
  call compare(log, 500, 0.0_rk)
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Boxes here and there in the unit cube, many of them in one place; each asks for the others.
  subroutine compare(log, num, width)
    type(test_log), intent(inout) :: log
    integer, intent(in) :: num
    real(rk), intent(in) :: width
    real(rk) :: low(3, num), high(3, num)
    type(box_tree) :: tree
    integer, allocatable :: found(:)
    logical :: meets(num), is_found(num)
    integer :: i, k, num_found
    logical :: is_right
    do i = 1, num
      low(:, i) = modulo([0.618034_rk, 0.754878_rk, 0.569840_rk]*i, 1.0_rk)
      if (modulo(i, 5) == 0) low(:, i) = 0.5_rk
      high(:, i) = low(:, i) + width*[1.0_rk, 2.0_rk, 0.5_rk]
    end do
    call build_tree(low, high, tree)
    is_right = .true.
    do i = 1, num
      call find_boxes(tree, low(:, i), high(:, i), num_found, found)
      is_found = .false.
      is_found(found(:num_found)) = .true.
      do k = 1, num
        meets(k) = all(low(:, k) <= high(:, i) .and. high(:, k) >= low(:, i))
      end do
      is_right = is_right .and. all(meets .eqv. is_found) .and. count(meets) == num_found
    end do
    call check(log, is_right, 'the tree finds the boxes that meet, each once')
  end subroutine compare
end program test_facet_search
