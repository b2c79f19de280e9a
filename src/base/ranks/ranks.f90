!> The processes (ranks) of a run under mpiexec; the plain program has one.
!>
!> All ranks take the same path through the program, with the same numbers, and meet in the
!> procedures of this module that exchange something. CMake chooses what stands behind it:
!> one_rank.c, or mpi_ranks.c with KEYWAY_PETSC.
module ranks
  use, intrinsic :: iso_c_binding, only: c_char, c_double, c_int, c_size_t
  use kinds, only: rk
  use errors, only: error_type, raise
  implicit none
  private
  public :: start_ranks, end_ranks, num_ranks, this_rank, is_first_rank, is_alone
  public :: exchange_seconds, num_ranks_here, add_over_ranks, gather_rows, is_true_everywhere
  public :: largest_of_ranks, number_of_first_rank, text_of_rank, share_error
  public :: gather_on_first_rank, exchange, of_all_ranks, starts_of_ranks

  !> For ranks that do not come, because they wait for this one elsewhere [s]. Rank 0 may write
  !> results meanwhile.
  integer(c_int), parameter :: patience = 300

  interface
    !> Joins the other ranks, where a launcher such as mpiexec has started the program.
    subroutine start_ranks() bind(c, name='keyway_start_ranks')
      implicit none
    end subroutine start_ranks

    !> Leaves the other ranks; a rank that is alone ends them with `code`.
    subroutine end_ranks(code) bind(c, name='keyway_end_ranks')
      import :: c_int
      implicit none
      integer(c_int), value :: code
    end subroutine end_ranks

    !> Time that this rank has spent in exchange with others, and waiting for them [s].
    function exchange_seconds() result(seconds) bind(c, name='keyway_exchange_seconds')
      import :: c_double
      implicit none
      real(c_double) :: seconds
    end function exchange_seconds

    ! Pure: the ranks do not change after `start_ranks`.
    pure function keyway_num_ranks() result(number) bind(c)
      import :: c_int
      implicit none
      integer(c_int) :: number
    end function keyway_num_ranks

    function keyway_num_ranks_here() result(number) bind(c)
      import :: c_int
      implicit none
      integer(c_int) :: number
    end function keyway_num_ranks_here

    pure function keyway_this_rank() result(number) bind(c)
      import :: c_int
      implicit none
      integer(c_int) :: number
    end function keyway_this_rank

    function keyway_is_alone() result(answer) bind(c)
      import :: c_int
      implicit none
      integer(c_int) :: answer
    end function keyway_is_alone

    function keyway_wait_for_ranks(seconds) result(all_come) bind(c)
      import :: c_int
      implicit none
      integer(c_int), value :: seconds
      integer(c_int) :: all_come
    end function keyway_wait_for_ranks

    subroutine keyway_add_over_ranks(x, length) bind(c)
      import :: c_double, c_size_t
      implicit none
      integer(c_size_t), value :: length
      real(c_double), intent(inout) :: x(length)
    end subroutine keyway_add_over_ranks

    subroutine keyway_gather_rows(own, all, num_ranks, first) bind(c)
      import :: c_double, c_int
      implicit none
      integer(c_int), value :: num_ranks
      integer(c_int), intent(in) :: first(num_ranks + 1)
      ! allow(assumed-size)
      real(c_double), intent(in) :: own(*)
      real(c_double), intent(out) :: all(first(num_ranks + 1))
    end subroutine keyway_gather_rows

    subroutine keyway_gather_on_first_rank(own, length, all, num_ranks, first) bind(c)
      import :: c_double, c_int
      implicit none
      integer(c_int), value :: length, num_ranks
      integer(c_int), intent(in) :: first(num_ranks + 1)
      real(c_double), intent(in) :: own(length)
      ! allow(assumed-size)
      real(c_double), intent(inout) :: all(*)
    end subroutine keyway_gather_on_first_rank

    subroutine keyway_exchange(num_neighbours, neighbour, first, sent, received) bind(c)
      import :: c_double, c_int
      implicit none
      integer(c_int), value :: num_neighbours
      integer(c_int), intent(in) :: neighbour(num_neighbours), first(num_neighbours + 1)
      ! allow(assumed-size)
      real(c_double), intent(in) :: sent(*)
      ! allow(assumed-size)
      real(c_double), intent(inout) :: received(*)
    end subroutine keyway_exchange

    function keyway_least_of_ranks(number) result(least) bind(c)
      import :: c_int
      implicit none
      integer(c_int), value :: number
      integer(c_int) :: least
    end function keyway_least_of_ranks

    subroutine keyway_share_text(rank, text, length) bind(c)
      import :: c_char, c_int
      implicit none
      integer(c_int), value :: rank, length
      character(kind=c_char), intent(inout) :: text(length)
    end subroutine keyway_share_text
  end interface

  !> Replaces an array by its sum over all ranks, which has the same bits on all of them.
  interface add_over_ranks
    module procedure add_vectors, add_matrices
  end interface add_over_ranks

contains

  !> Ranks of the run.
  pure integer function num_ranks()
    num_ranks = int(keyway_num_ranks())
  end function num_ranks

  !> Ranks of the run on this machine.
  integer function num_ranks_here()
    num_ranks_here = int(keyway_num_ranks_here())
  end function num_ranks_here

  !> Number of this rank, from 0.
  pure integer function this_rank()
    this_rank = int(keyway_this_rank())
  end function this_rank

  !> Whether this rank prints and writes.
  pure logical function is_first_rank()
    is_first_rank = keyway_this_rank() == 0
  end function is_first_rank

  !> Whether this rank has waited for the others without success.
  logical function is_alone()
    is_alone = keyway_is_alone() /= 0
  end function is_alone

  !> The sum of vectors.
  subroutine add_vectors(x)
    real(rk), contiguous, intent(inout) :: x(:) !< of one size on all ranks
    call keyway_add_over_ranks(x, size(x, kind=c_size_t))
  end subroutine add_vectors

  !> The sum of matrices.
  subroutine add_matrices(x)
    real(rk), contiguous, intent(inout) :: x(:, :) !< of one size on all ranks
    call keyway_add_over_ranks(x, size(x, kind=c_size_t))
  end subroutine add_matrices

  !> The numbers that the ranks have, on all ranks.
  function of_all_ranks(own) result(all)
    real(rk), intent(in) :: own
    real(rk) :: all(num_ranks())
    all = 0.0_rk
    all(this_rank() + 1) = own
    call add_over_ranks(all)
  end function of_all_ranks

  !> Where the items of each rank start if they follow each other, from 0, and how many all have.
  function starts_of_ranks(num_own) result(first)
    integer, intent(in) :: num_own !< items of this rank
    integer :: first(num_ranks() + 1)
    integer :: counts(num_ranks()), k
    counts = nint(of_all_ranks(real(num_own, rk)))
    first(1) = 0
    do k = 1, size(counts)
      first(k + 1) = first(k) + counts(k)
    end do
  end function starts_of_ranks

  !> Puts the rows of all ranks together, on all ranks.
  subroutine gather_rows(first, own, all)
    integer, intent(in) :: first(:) !< (ranks + 1) first row of each rank, from 0
    real(rk), contiguous, intent(in) :: own(:) !< of this rank
    real(rk), contiguous, intent(out) :: all(:)
    call keyway_gather_rows(own, all, int(size(first) - 1, c_int), int(first, c_int))
  end subroutine gather_rows

  !> Puts the numbers of all ranks together, on the first rank.
  subroutine gather_on_first_rank(own, first, all)
    real(rk), contiguous, intent(in) :: own(:) !< of this rank
    integer, intent(in) :: first(:) !< (ranks + 1) from 0; used on the first rank
    real(rk), contiguous, intent(inout) :: all(:) !< there; unchanged on the others
    call keyway_gather_on_first_rank(own, int(size(own), c_int), all, &
                                     int(size(first) - 1, c_int), int(first, c_int))
  end subroutine gather_on_first_rank

  !> Sends numbers to some ranks, and receives as many from each of them.
  subroutine exchange(neighbour, first, sent, received)
    integer, intent(in) :: neighbour(:) !< ranks; each has this one among its neighbours
    integer, intent(in) :: first(:) !< (neighbours + 1) first number of each neighbour
    real(rk), contiguous, intent(in) :: sent(:)
    real(rk), contiguous, intent(inout) :: received(:)
    call keyway_exchange(int(size(neighbour), c_int), int(neighbour, c_int), &
                         int(first - 1, c_int), sent, received)
  end subroutine exchange

  !> Whether something holds on all ranks.
  logical function is_true_everywhere(holds)
    logical, intent(in) :: holds
    is_true_everywhere = keyway_least_of_ranks(merge(1_c_int, 0_c_int, holds)) == 1
  end function is_true_everywhere

  !> The largest number that any rank has.
  integer function largest_of_ranks(own) result(number)
    integer, intent(in) :: own !< more than -huge(1)
    number = -int(keyway_least_of_ranks(int(-own, c_int)))
  end function largest_of_ranks

  !> The number that the first rank has, on all ranks.
  integer function number_of_first_rank(own) result(number)
    integer, intent(in) :: own !< used on the first rank; less than huge(1)
    number = int(keyway_least_of_ranks(int(merge(own, huge(1), is_first_rank()), c_int)))
  end function number_of_first_rank

  !> An error of one rank becomes that of all: the error of the lowest rank that has one. A rank
  !> with an error that the others do not meet here is alone from then on.
  subroutine share_error(error)
    type(error_type), allocatable, intent(inout) :: error
    character(:), allocatable :: text
    integer(c_int) :: rank
    integer :: code
    if (keyway_num_ranks() == 1) return
    if (keyway_wait_for_ranks(merge(patience, 0_c_int, allocated(error))) == 0) return
    rank = keyway_this_rank()
    if (.not. allocated(error)) rank = keyway_num_ranks()
    rank = keyway_least_of_ranks(rank)
    if (rank == keyway_num_ranks()) return
    text = ''
    code = 0
    if (allocated(error)) then
      text = error%message
      if (rank == keyway_this_rank()) code = error%exit_code
    end if
    code = largest_of_ranks(code)
    text = text_of_rank(int(rank), text)
    if (.not. allocated(error)) call raise(error, text, code)
  end subroutine share_error

  !> The text of one rank, on all ranks.
  function text_of_rank(rank, own) result(text)
    integer, intent(in) :: rank
    character(*), intent(in) :: own !< used on that rank
    character(:), allocatable :: text
    character(kind=c_char), allocatable :: letters(:)
    integer :: length, i
    length = largest_of_ranks(merge(len(own), 0, rank == this_rank()))
    allocate (character(length) :: text)
    allocate (letters(length), source=' ')
    do i = 1, merge(length, 0, rank == this_rank())
      letters(i) = own(i:i)
    end do
    call keyway_share_text(int(rank, c_int), letters, int(length, c_int))
    do i = 1, length
      text(i:i) = letters(i)
    end do
  end function text_of_rank
end module ranks
