!> What stays from step to step, for loads and for degrees of freedom.
program test_load_books
  use amplitudes, only: amplitude
  use dof_tables, only: dof_table
  use kinds, only: rk
  use load_books, only: load_book
  use step_plan, only: step_load
  use testing, only: check, check_close, test_log
  implicit none
  type(test_log) :: log
  type(amplitude) :: histories(2)
  log%suite = 'load_books'
  histories(1)%time = [0.0_rk, 1.0_rk]
  histories(1)%value = [0.0_rk, 0.5_rk]
  histories(2)%time = [0.0_rk, 10.0_rk]
  histories(2)%value = [0.0_rk, 10.0_rk]
  histories(2)%uses_total_time = .true.
  call factor_changes()
  call pattern_changes()
  call history_replaces()
  call new_clears()
  call amplitude_is_held()
  call perturbation_moves_nothing()
  call table_follows_the_same_rules()
  write (*, '(i0,a,i0,a)') log%passed, ' passed, ', log%failed, ' failed'
  if (log%failed > 0) error stop 1

contains

  !> Gives a load as the keywords do: an old one is taken over, a new one entered.
  subroutine give(book, pattern, factor, history, number)
    type(load_book), intent(inout) :: book
    character(*), intent(in) :: pattern
    real(rk), intent(in) :: factor
    integer, intent(in) :: history, number
    integer :: known
    call book%take_over('DLOAD', 'DAM', pattern, factor, history, known)
    if (known == 0) call book%enter('DLOAD', 'DAM', pattern, factor, history, number)
  end subroutine give

  subroutine factor_changes()
    type(load_book) :: book
    type(step_load), allocatable :: loads(:)
    call give(book, 'down', 2.0_rk, 0, 1)
    call book%end_step(histories, 1.0_rk, 1.0_rk, .false.)
    call give(book, 'down', 3.0_rk, 0, 2)
    loads = book%loads_of_step()
    call check(log, size(loads) == 1, 'the same load given again stays one load')
    call check_close(log, loads(1)%start_factor, 2.0_rk, 0.0_rk, 'it starts where it was')
    call check_close(log, loads(1)%end_factor, 3.0_rk, 0.0_rk, 'it ends where it is asked to')
  end subroutine factor_changes

  subroutine pattern_changes()
    type(load_book) :: book
    type(step_load), allocatable :: loads(:)
    call give(book, 'down', 2.0_rk, 0, 1)
    call give(book, 'along', 5.0_rk, 0, 2)
    call check(log, size(book%loads_of_step()) == 2, 'two loads of one step both act')
    call book%end_step(histories, 1.0_rk, 1.0_rk, .false.)
    call give(book, 'across', 4.0_rk, 0, 3)
    loads = book%loads_of_step()
    call check(log, size(loads) == 3, 'old patterns fade while the new one comes in')
    call check_close(log, loads(1)%end_factor, 0.0_rk, 0.0_rk, 'the old one ends at nothing')
    call check_close(log, loads(3)%start_factor, 0.0_rk, 0.0_rk, 'the new one starts there')
    call book%end_step(histories, 1.0_rk, 2.0_rk, .false.)
    call check(log, size(book%loads_of_step()) == 1, 'what has faded is gone')
  end subroutine pattern_changes

  !> A load with an amplitude has its value from the start of the step: what it replaces is gone.
  subroutine history_replaces()
    type(load_book) :: book
    type(step_load), allocatable :: loads(:)
    call give(book, 'down', 2.0_rk, 0, 1)
    call book%end_step(histories, 1.0_rk, 1.0_rk, .false.)
    call give(book, 'across', 4.0_rk, 1, 2)
    loads = book%loads_of_step()
    call check(log, size(loads) == 1, 'a load with an amplitude replaces the old pattern')
    call check(log, loads(1)%load == 2, 'the new load acts')
    call book%end_step(histories, 1.0_rk, 2.0_rk, .false.)
    call check(log, size(book%loads_of_step()) == 1, 'the old pattern does not come back')
  end subroutine history_replaces

  subroutine new_clears()
    type(load_book) :: book
    type(step_load), allocatable :: loads(:)
    call give(book, 'down', 2.0_rk, 0, 1)
    call book%clear_old('DLOAD')
    call check(log, size(book%loads_of_step()) == 1, 'OP=NEW keeps the loads of its own step')
    call book%end_step(histories, 1.0_rk, 1.0_rk, .false.)
    call book%clear_old('CLOAD')
    loads = book%loads_of_step()
    call check_close(log, loads(1)%end_factor, 2.0_rk, 0.0_rk, 'OP=NEW is for its family')
    call book%clear_old('DLOAD')
    loads = book%loads_of_step()
    call check_close(log, loads(1)%end_factor, 0.0_rk, 0.0_rk, 'OP=NEW ends older loads')
  end subroutine new_clears

  subroutine amplitude_is_held()
    type(load_book) :: book
    type(step_load), allocatable :: loads(:)
    call give(book, 'a', 4.0_rk, 1, 1)
    call book%enter('DSLOAD', 'B', '', 3.0_rk, 2, 2)
    call book%end_step(histories, 1.0_rk, 1.0_rk, .false.)
    loads = book%loads_of_step()
    call check(log, loads(1)%amplitude == 0, 'a history over the step ends with it')
    call check_close(log, loads(1)%end_factor, 2.0_rk, 1.0e-15_rk, 'and its last value is held')
    call check(log, loads(2)%amplitude == 2, 'a history over total time goes on')
    call check_close(log, loads(2)%end_factor, 3.0_rk, 0.0_rk, 'with its factor')
  end subroutine amplitude_is_held

  subroutine perturbation_moves_nothing()
    type(load_book) :: book
    type(step_load), allocatable :: loads(:)
    call give(book, 'down', 2.0_rk, 0, 1)
    call book%end_step(histories, 0.0_rk, 0.0_rk, .true.)
    loads = book%loads_of_step()
    call check_close(log, loads(1)%start_factor, 0.0_rk, 0.0_rk, 'frequencies apply no load')
    call check_close(log, loads(1)%end_factor, 2.0_rk, 0.0_rk, 'which is still to come')
  end subroutine perturbation_moves_nothing

  subroutine table_follows_the_same_rules()
    type(dof_table) :: table
    call table%prepare(2)
    call table%add([1], 3, 5.0_rk, 0)
    call table%add([1, 2], 3, 1.0_rk, 0)
    call check_close(log, table%value(3, 1), 6.0_rk, 0.0_rk, 'forces of one step add up')
    call table%end_step(histories, 1.0_rk, 1.0_rk, .false.)
    call table%add([1], 3, 2.0_rk, 1)
    call check_close(log, table%value(3, 1), 2.0_rk, 0.0_rk, 'a later step replaces them')
    call table%clear_old()
    call check(log, table%is_set(3, 1) .and. .not. table%is_set(3, 2), 'OP=NEW keeps new ones')
    call table%end_step(histories, 1.0_rk, 2.0_rk, .false.)
    call check_close(log, table%value(3, 1), 1.0_rk, 1.0e-15_rk, 'the last value is held')
    call check(log, table%history(3, 1) == 0, 'without its history')
  end subroutine table_follows_the_same_rules
end program test_load_books
