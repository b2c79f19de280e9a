!> Services for a UMAT by the names of its interface: XIT, STDB_ABQERR,
!> GETNUMCPUS, GETRANK, GET_THREAD_ID. GETJOBNAME, GETOUTDIR, GETVRM, GETPARTINFO and the mutexes
!> are in umat_bridge.c.
module umat_services
  use, intrinsic :: iso_c_binding, only: c_char, c_double, c_int, c_size_t
  use omp_lib, only: omp_get_thread_num
  use umat_interface, only: keyway_umat_count, keyway_umat_stop
  implicit none
  private
  public :: xit, stdb_abqerr, getnumcpus, getrank, get_thread_id, warn
  public :: message_unit

  integer, parameter :: message_unit = 7 !< JOB.msg, for output of a UMAT
  integer, parameter :: letters_of_word = 8 !< of an entry of CHARV
  integer(c_int), parameter :: information = 1, warning = -1, fault = -2, fatal_fault = -3

contains

  !> Ends the call and cuts the increment.
  subroutine xit() bind(c, name='xit_')
    call give_up('XIT was called')
  end subroutine xit

  !> Writes a message; %I, %R and %S are replaced by the next integer, real and text. The kind -3
  !> ends the call and cuts the increment.
  subroutine stdb_abqerr(lop, text, intv, realv, charv, num_letters) &
    bind(c, name='stdb_abqerr_')
    integer(c_int), intent(in) :: lop !< 1 information, -1 warning, -2 error, -3 fatal error
    integer(c_size_t), intent(in), value :: num_letters !< of the text, a hidden argument
    character(kind=c_char), intent(in) :: text(num_letters)
    ! allow(assumed-size)
    integer(c_int), intent(in) :: intv(*)
    ! allow(assumed-size)
    real(c_double), intent(in) :: realv(*)
    ! allow(assumed-size)
    character(kind=c_char), intent(in) :: charv(letters_of_word, *)
    character(:), allocatable :: message
    integer :: i, num_integers, num_reals, num_words
    character(24) :: room
    num_integers = 0
    num_reals = 0
    num_words = 0
    message = ''
    i = 1
    do while (i <= num_letters)
      select case (mark_at(text, i))
      case ('I', 'i')
        num_integers = num_integers + 1
        write (room, '(i0)') intv(num_integers)
        message = message//trim(room)
      case ('R', 'r')
        num_reals = num_reals + 1
        write (room, '(g0.7)') realv(num_reals)
        message = message//trim(room)
      case ('S', 's')
        num_words = num_words + 1
        message = message//trim(joined(charv(:, num_words)))
      case default
        message = message//text(i)
        i = i - 1
      end select
      i = i + 2
    end do
    call pass_on(lop, trim(message))
  end subroutine stdb_abqerr

  !> The letter after '%', a blank for other marks.
  pure character function mark_at(text, i)
    character(kind=c_char), intent(in) :: text(:)
    integer, intent(in) :: i
    mark_at = ' '
    if (text(i) == '%' .and. i < size(text)) mark_at = text(i + 1)
  end function mark_at

  pure function joined(letters) result(text)
    character(kind=c_char), intent(in) :: letters(:)
    character(size(letters)) :: text
    integer :: i
    do i = 1, size(letters)
      text(i:i) = letters(i)
    end do
  end function joined

  subroutine pass_on(lop, message)
    integer(c_int), intent(in) :: lop
    character(*), intent(in) :: message
    select case (lop)
    case (information)
      call write_message('note: '//message)
    case (warning)
      call keyway_umat_count(0_c_int)
      call write_message('warning: '//message)
    case (fault)
      call keyway_umat_count(1_c_int)
      call write_message('error: '//message)
    case (fatal_fault)
      call keyway_umat_count(1_c_int)
      call write_message('fatal error: '//message)
      call give_up(message)
    case default
      call write_message(message)
    end select
  end subroutine pass_on

  !> Writes a line to the message file, if there is one.
  subroutine write_message(line)
    character(*), intent(in) :: line
    logical :: is_open
    inquire (unit=message_unit, opened=is_open)
    if (is_open) write (message_unit, '(a)') line
  end subroutine write_message

  subroutine give_up(message)
    character(*), intent(in) :: message
    call keyway_umat_stop(message, len(message, c_size_t))
  end subroutine give_up

  !> Number of processes: 1; GET_THREAD_ID identifies threads.
  subroutine getnumcpus(num_processes) bind(c, name='getnumcpus_')
    integer(c_int), intent(out) :: num_processes
    num_processes = 1
  end subroutine getnumcpus

  !> Number of this process, from 0.
  subroutine getrank(process) bind(c, name='getrank_')
    integer(c_int), intent(out) :: process
    process = 0
  end subroutine getrank

  !> Number of this thread, from 0.
  integer(c_int) function get_thread_id() bind(c, name='get_thread_id_') result(thread)
    thread = int(omp_get_thread_num(), c_int)
  end function get_thread_id

  !> Writes a warning of the bridge.
  subroutine warn(text, num_letters) bind(c, name='keyway_umat_warn')
    integer(c_size_t), intent(in), value :: num_letters
    character(kind=c_char), intent(in) :: text(num_letters)
    call pass_on(warning, joined(text))
  end subroutine warn
end module umat_services
