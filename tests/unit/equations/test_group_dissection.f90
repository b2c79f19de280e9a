!> Nested dissection where SIGTERM arrives: METIS does not see it, the order is found, and the
!> program gets the signal afterwards.
program test_group_dissection
  use, intrinsic :: iso_c_binding, only: c_int
  use group_dissection, only: dissect_graph, vertex_graph
  use stop_signals, only: is_asked_to_stop, name_of_signal, outlive_signal
  use testing, only: check, check_text, test_log
  implicit none

  interface
    function getpid() bind(c) result(number)
      import :: c_int
      implicit none
      integer(c_int) :: number
    end function getpid
  end interface

  integer, parameter :: edge = 30 !< vertices of a lattice along each axis; 0.2 s of METIS's work
  integer, parameter :: most_orders = 200 !< the signal comes within the first ones
  type(test_log) :: log
  type(vertex_graph) :: lattice
  integer :: order(edge**3), k, status
  character(12) :: process

  log%suite = 'group_dissection'
  lattice = lattice_graph()
  call outlive_signal()
  write (process, '(i0)') getpid()
  call execute_command_line('(sleep 0.3; kill -TERM '//trim(process)//') &')
  do k = 1, most_orders
    call dissect_graph(lattice, order, status)
    if (status /= 0 .or. is_asked_to_stop()) exit
  end do
  call check(log, status == 0, 'ordered')
  call check(log, is_permutation(order), 'all vertices')
  call check_text(log, name_of_signal(), 'SIGTERM', 'the signal arrives')
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> The vertices of a lattice, each with up to six neighbours.
  function lattice_graph() result(graph)
    type(vertex_graph) :: graph
    integer :: i, v, last
    integer, parameter :: step(3) = [1, edge, edge**2]
    allocate (graph%weight(edge**3), source=3)
    allocate (graph%group(edge**3), source=0)
    allocate (graph%start(edge**3 + 1), source=0)
    allocate (graph%neighbour(2*3*edge**2*(edge - 1)))
    last = 0
    do v = 0, edge**3 - 1
      associate (place => [(mod(v/step(i), edge), i=1, 3)])
        associate (near => [pack(v - step, place > 0), pack(v + step, place < edge - 1)])
          graph%neighbour(last + 1:last + size(near)) = near
          last = last + size(near)
        end associate
      end associate
      graph%start(v + 2) = last
    end do
  end function lattice_graph

  !> Whether each vertex is there once.
  pure logical function is_permutation(vertices)
    integer, intent(in) :: vertices(:) !< counted from 1
    logical :: is_there(size(vertices))
    is_there = .false.
    is_there(vertices) = .true.
    is_permutation = all(is_there)
  end function is_permutation
end program test_group_dissection
