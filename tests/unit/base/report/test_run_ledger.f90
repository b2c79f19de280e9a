!> The parts of the ledger add up to the time of the run, at any moment and after any error.
program test_run_ledger
  use kinds, only: rk
  use ledger_text, only: text_of_ledger
  use run_ledger, only: ledger, ledger_part
  use testing, only: check, check_close, check_text, test_log
  use timer, only: peak_memory, wall_clock
  use write_text, only: as_text
  implicit none
  !> Sums of some 30 differences of clock readings, which are some 1e5 s (round-off 1e-11 s).
  real(rk), parameter :: clock_roundoff = 1.0e-8_rk
  type(test_log) :: log
  log%suite = 'run_ledger'
  call nested_parts()
  call middle_of_a_part()
  call error_in_a_part()
  call shared_part()
  call copies()
  call growing_memory()
  call table()
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> An inner part pauses the outer part.
  subroutine nested_parts()
    type(ledger) :: costs
    type(ledger_part) :: outer, inner
    real(rk) :: before_inner, after_inner, began, ended
    integer :: i
    began = wall_clock()
    call costs%open(began - 2.0_rk)
    call costs%start('iterate', 'structure', 'solver')
    before_inner = wall_clock()
    do i = 1, 3
      call costs%start('factor', 'structure', 'solver')
      call wait_for(1.0e-3_rk)
      call costs%stop()
    end do
    after_inner = wall_clock()
    call costs%stop()
    ended = wall_clock()
    call check_sum(costs, 'nested parts')
    outer = part_of(costs, 'iterate structure')
    inner = part_of(costs, 'factor structure')
    call check(log, inner%num_calls == 3 .and. outer%num_calls == 1, 'calls')
    call check(log, inner%wall_time >= 3.0e-3_rk &
               .and. inner%wall_time <= after_inner - before_inner, 'inner time')
    call check(log, outer%wall_time <= ended - began - 3.0e-3_rk, 'outer time, paused meanwhile')
    inner = part_of(costs, 'other work')
    call check(log, inner%wall_time >= 2.0_rk, 'time before the first part')
  end subroutine nested_parts

  !> The ledger is right while parts run.
  subroutine middle_of_a_part()
    type(ledger) :: costs
    type(ledger_part) :: part
    call costs%open()
    call costs%start('iterate', 'structure', 'solver')
    call costs%start('solve', 'structure', 'solver')
    call wait_for(1.0e-3_rk)
    call check_sum(costs, 'middle of a part')
    part = part_of(costs, 'solve structure')
    call check(log, part%wall_time >= 1.0e-3_rk, 'time of a part that runs')
    call check(log, part%num_calls == 0, 'only calls that have ended count')
    call wait_for(1.0e-3_rk)
    call costs%stop()
    part = part_of(costs, 'solve structure')
    call check(log, part%wall_time >= 2.0e-3_rk, 'the part went on after the ledger was read')
    call check(log, part%num_calls == 1, 'one call')
  end subroutine middle_of_a_part

  !> Parts that an error leaves running end with the part around them.
  subroutine error_in_a_part()
    type(ledger) :: costs
    type(ledger_part) :: part
    call costs%open()
    call costs%start('iterate', 'structure', 'solver')
    call costs%start('iterate', 'joints', 'joint')
    call costs%start('factor', 'structure', 'solver')
    call costs%stop('write VTK')
    call costs%stop('iterate structure')
    call wait_for(1.0e-3_rk)
    part = part_of(costs, 'other work')
    call check(log, part%wall_time >= 1.0e-3_rk, 'no part runs')
    part = part_of(costs, 'factor structure')
    call check(log, part%num_calls == 1, 'the innermost part has ended')
    call costs%stop()
    call costs%stop()
    call costs%start('write', 'VTK', 'output')
    call costs%start('write', 'CSV', 'output')
    call costs%stop_all()
    part = part_of(costs, 'write VTK')
    call check(log, part%num_calls == 1, 'all parts have ended')
    call costs%stop_all()
    part = part_of(costs, 'other work')
    call check(log, part%num_calls == 1, 'one run')
    call check_sum(costs, 'after errors')
  end subroutine error_in_a_part

  !> Work on a group is divided among its members and added to their own work.
  subroutine shared_part()
    type(ledger) :: costs
    type(ledger_part) :: left, right
    integer :: i
    call costs%open()
    call costs%share('joints', 'joint', ['LEFT ', 'RIGHT', 'EMPTY'], [1.0_rk, 3.0_rk, 0.0_rk])
    call costs%share('solids', 'inelastic', ['DAM'], [0.0_rk])
    do i = 1, 2
      call costs%start('iterate', 'joints', 'joint')
      call wait_for(1.0e-3_rk)
      call costs%stop()
    end do
    left = part_of(costs, 'iterate LEFT')
    right = part_of(costs, 'iterate RIGHT')
    call check_close(log, right%wall_time, 3.0_rk*left%wall_time, clock_roundoff, 'by weight')
    call check_close(log, right%memory, 3.0_rk*left%memory, clock_roundoff, 'memory by weight')
    call check(log, left%num_calls == 2 .and. right%num_calls == 2, 'calls of the group')
    call check_text(log, right%kind, 'joint', 'kind')
    right = part_of(costs, 'iterate EMPTY')
    call check(log, right%num_calls == 2 .and. right%wall_time <= 0.0_rk, 'no weight, no time')
    call costs%start('update', 'solids', 'inelastic')
    call costs%stop()
    call check(log, has_part(costs, 'update solids'), 'a group without weight stays undivided')
    call check(log,.not. has_part(costs, 'iterate joints'), 'a divided group is no part')
    call check_sum(costs, 'shared parts')
  end subroutine shared_part

  !> Copies of a ledger share its book; a ledger that is not open books nothing.
  subroutine copies()
    type(ledger) :: costs, copy, closed
    type(ledger_part), allocatable :: parts(:)
    real(rk) :: wall_time
    call costs%open()
    copy = costs
    call costs%start('iterate', 'structure', 'solver')
    call copy%start('solve', 'structure', 'solver')
    call copy%stop()
    call costs%stop()
    call check(log, has_part(costs, 'solve structure'), 'booked through a copy')
    call closed%start('solve', 'structure', 'solver')
    call closed%stop()
    call closed%stop_all()
    call closed%read_parts(parts, wall_time)
    call check(log, size(parts) == 0 .and. wall_time <= 0.0_rk, 'not open')
  end subroutine copies

  !> Growth of the peak memory is booked on the part that runs, also after its first calls.
  subroutine growing_memory()
    type(ledger) :: costs
    type(ledger_part) :: part
    real(rk), allocatable, volatile :: room(:) ! volatile: else compilers leave it out
    real(rk), parameter :: bytes_per_megabyte = 1048576.0_rk
    integer :: i
    call costs%open()
    do i = 1, 6
      call costs%start('condense', 'J1', 'joint')
      if (i == 6) then
        allocate (room(25*1048576))
        room = 1.0_rk
      end if
      call costs%stop()
    end do
    part = part_of(costs, 'condense J1')
    call check(log, part%memory > 0.9_rk*8.0_rk*size(room)/bytes_per_megabyte, '200 MB: '// &
               as_text(part%memory))
    call check_close(log, sum_of_memory(costs), peak_memory(), 1.0e-6_rk, 'memory adds up')
  end subroutine growing_memory

  !> The table holds the longest parts; the others are one row.
  subroutine table()
    type(ledger) :: costs
    character(:), allocatable :: text
    character(1), parameter :: end_of_line = new_line('a')
    integer :: i, num_rows
    ! On a busy machine each part may wait for its processor: 30 000 s are far above that.
    call costs%open(wall_clock() - 30000.0_rk)
    do i = 1, 20
      call costs%start('write', 'FILE '//as_text(i), 'output')
      if (i == 7) call wait_for(5.0e-3_rk)
      call costs%stop()
    end do
    text = text_of_ledger(costs)
    num_rows = count([(text(i:i) == end_of_line, i=1, len(text))])
    call check(log, num_rows == 14, 'rows: '//as_text(num_rows))
    call check(log, index(text, 'other work') < index(text, 'write FILE 7'//end_of_line), 'sorted')
    call check(log, index(text, '  8  other') > 0, 'the rest: '//text)
    call check(log, index(text, ' 100.0% ') > 0, 'share of the longest part')
  end subroutine table

  !> Spends some time.
  subroutine wait_for(seconds)
    real(rk), intent(in) :: seconds
    real(rk) :: began
    began = wall_clock()
    do while (wall_clock() - began < seconds)
    end do
  end subroutine wait_for

  !> The times of all parts add up to the time since the ledger was opened.
  subroutine check_sum(costs, what)
    type(ledger), intent(in) :: costs
    character(*), intent(in) :: what
    type(ledger_part), allocatable :: parts(:)
    real(rk) :: wall_time
    call costs%read_parts(parts, wall_time)
    call check_close(log, sum(parts%wall_time), wall_time, clock_roundoff, what//' add up')
    call check(log, all(parts%wall_time >= 0.0_rk), what//': no negative time')
  end subroutine check_sum

  !> Memory of all parts [MB].
  real(rk) function sum_of_memory(costs)
    type(ledger), intent(in) :: costs
    type(ledger_part), allocatable :: parts(:)
    real(rk) :: wall_time
    call costs%read_parts(parts, wall_time)
    sum_of_memory = sum(parts%memory)
  end function sum_of_memory

  !> Is there a part of this name?
  logical function has_part(costs, name)
    type(ledger), intent(in) :: costs
    character(*), intent(in) :: name
    type(ledger_part) :: part
    part = part_of(costs, name)
    has_part = allocated(part%work)
  end function has_part

  !> A part by its name; empty where there is none.
  type(ledger_part) function part_of(costs, name) result(part)
    type(ledger), intent(in) :: costs
    character(*), intent(in) :: name
    type(ledger_part), allocatable :: parts(:)
    real(rk) :: wall_time
    integer :: i
    call costs%read_parts(parts, wall_time)
    do i = 1, size(parts)
      if (parts(i)%name() == name) part = parts(i)
    end do
  end function part_of
end program test_run_ledger
