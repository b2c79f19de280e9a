!> How evenly the work of a run is divided: the ledgers of all ranks together.
module rank_balance
  use kinds, only: rk
  use ranks, only: exchange_seconds, num_ranks, of_all_ranks, text_of_rank, this_rank
  use run_ledger, only: ledger, ledger_part
  use timer, only: peak_memory
  use write_text, only: as_text, as_short_text
  implicit none
  private
  public :: balance_of_ranks, spread, gather_balance

  !> A quantity over the ranks.
  type :: spread
    character(:), allocatable :: name
    real(rk) :: least = 0.0_rk, mean = 0.0_rk, most = 0.0_rk
  end type spread

  !> The balance of a run; empty for one rank.
  type :: balance_of_ranks
    integer :: num_ranks = 0
    type(spread) :: elements !< of the parts of the mesh
    type(spread) :: memory !< largest so far [MB]
    type(spread) :: exchange !< time in exchange with other ranks and waiting for them [s]
    real(rk) :: share = 0.0_rk !< mean of `exchange` over the time of the run
    type(spread), allocatable :: parts(:) !< times of the parts of the ledger [s]
  contains
    procedure :: lines
  end type balance_of_ranks

  character(*), parameter :: between = ';'
  integer, parameter :: most_rows = 8 !< parts that the log has

contains

  !> Gathers the ledgers at the end of a run. All ranks call this.
  subroutine gather_balance(costs, rank_of_element, balance)
    type(ledger), intent(in) :: costs
    integer, intent(in) :: rank_of_element(:) !< (elements) from 0
    type(balance_of_ranks), intent(out) :: balance
    type(ledger_part), allocatable :: parts(:)
    character(:), allocatable :: names
    real(rk) :: wall_time
    integer :: i, first, last
    if (num_ranks() == 1) return
    balance%num_ranks = num_ranks()
    balance%elements = spread_of('elements', real(count(rank_of_element == this_rank()), rk))
    balance%exchange = spread_of('exchange', exchange_seconds())
    balance%memory = spread_of('memory', peak_memory())
    call costs%read_parts(parts, wall_time)
    balance%share = balance%exchange%mean/max(wall_time, tiny(1.0_rk))
    names = ''
    do i = 1, size(parts)
      names = names//parts(i)%name()//between
    end do
    names = text_of_rank(0, names)
    allocate (balance%parts(count([(names(i:i) == between, i=1, len(names))])))
    first = 1
    do i = 1, size(balance%parts)
      last = first + index(names(first:), between) - 2
      balance%parts(i) = spread_of(names(first:last), time_of(parts, names(first:last)))
      first = last + 2
    end do
  end subroutine gather_balance

  !> Time of a part of this rank; 0 for a part that other ranks have.
  real(rk) function time_of(parts, name) result(time)
    type(ledger_part), intent(in) :: parts(:)
    character(*), intent(in) :: name
    integer :: i
    time = 0.0_rk
    do i = 1, size(parts)
      if (parts(i)%name() == name) time = time + parts(i)%wall_time
    end do
  end function time_of

  !> The spread of a quantity of which each rank has a value.
  function spread_of(name, own) result(over)
    character(*), intent(in) :: name
    real(rk), intent(in) :: own
    type(spread) :: over
    real(rk), allocatable :: all(:)
    all = of_all_ranks(own)
    over%name = name
    over%least = minval(all)
    over%mean = sum(all)/size(all)
    over%most = maxval(all)
  end function spread_of

  !> The balance as lines of the log: elements, memory, exchange, the longest parts.
  function lines(self) result(text)
    class(balance_of_ranks), intent(in) :: self
    character(:), allocatable :: text !< with new_line between them; '' for one rank
    integer :: i, k
    logical, allocatable :: is_left(:)
    text = ''
    if (self%num_ranks == 0) return
    allocate (is_left(size(self%parts)), source=.true.)
    text = as_text(self%num_ranks)//' ranks, least, mean and most of a rank: elements '// &
           row(self%elements)//'; memory [MB] '//row(self%memory)//new_line('a')// &
           'exchange between ranks and waiting [s] '//row(self%exchange)//', '// &
           as_short_text(100.0_rk*self%share)//' % of the run'
    do k = 1, min(most_rows, size(self%parts))
      i = maxloc(self%parts%most, dim=1, mask=is_left)
      is_left(i) = .false.
      text = text//new_line('a')//self%parts(i)%name//' [s] '//row(self%parts(i))
    end do
  end function lines

  !> The three numbers of a spread.
  function row(over) result(text)
    type(spread), intent(in) :: over
    character(:), allocatable :: text
    text = as_short_text(over%least)//', '//as_short_text(over%mean)//', '// &
           as_short_text(over%most)
  end function row
end module rank_balance
