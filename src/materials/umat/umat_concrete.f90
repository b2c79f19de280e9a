!> Constants and state of plastic-damage concrete as PROPS and STATEV of a UMAT; the numbers are
!> explained in umat_damage_plasticity.f90.
module umat_concrete
  use damage_checks, only: find_longest_band, find_table_faults, is_too_long, table_fault
  use damage_constants, only: concrete_constants
  use damage_model, only: concrete_model, make_concrete_model
  use kinds, only: rk
  use write_text, only: as_text
  implicit none
  private
  public :: make_model

  integer, parameter :: num_scalars = 18 !< constants before the tables
  integer, parameter :: own_width = 14 !< in place of CELENT
  integer, parameter :: first_count = 15 !< position of the first of four numbers of rows
  character(12), parameter :: kinds_of_table(0:2) = ['STRAIN      ', 'DISPLACEMENT', 'GFI         ']
  character(10), parameter :: recoveries(0:2) = ['LEE-FENVES', 'SIGN      ', 'ENERGY    ']

contains

  !> Reads PROPS; `fault` is a message, '' without a fault.
  subroutine read_constants(props, constants, fault)
    real(rk), intent(in) :: props(:)
    type(concrete_constants), intent(out) :: constants
    character(:), allocatable, intent(out) :: fault
    integer :: first, num_rows(4)
    fault = ''
    if (size(props) < num_scalars) then
      fault = 'fewer than '//as_text(num_scalars)//' constants'
      return
    end if
    num_rows = nint(props(first_count:num_scalars))
    call check_scalars(props, num_rows, fault)
    if (len(fault) > 0) return
    constants%young = props(1)
    constants%poisson = props(2)
    constants%dilation = props(3)
    constants%offset = props(4)
    constants%biaxial_ratio = props(5)
    constants%meridian_ratio = props(6)
    constants%viscosity = props(7)
    constants%recovery = recoveries(nint(props(8)))
    constants%tension_recovery = props(9)
    constants%compression_recovery = props(10)
    constants%stiffening = kinds_of_table(nint(props(11)))
    constants%tension_damage_type = kinds_of_table(nint(props(12)))
    constants%lowers_strength = nint(props(13)) == 1
    first = num_scalars
    call take_table(props, num_rows(1), first, constants%tension)
    call take_table(props, num_rows(2), first, constants%tension_damage)
    call take_table(props, num_rows(3), first, constants%compression)
    call take_table(props, num_rows(4), first, constants%compression_damage)
  end subroutine read_constants

  !> Reads the next table, row by row; unallocated without rows.
  pure subroutine take_table(props, num_rows, first, table)
    real(rk), intent(in) :: props(:)
    integer, intent(in) :: num_rows
    integer, intent(inout) :: first !< constants read so far
    real(rk), allocatable, intent(out) :: table(:, :) !< (2, rows)
    if (num_rows == 0) return
    table = reshape(props(first + 1:first + 2*num_rows), [2, num_rows])
    first = first + 2*num_rows
  end subroutine take_table

  !> Checks the ranges of the scalars.
  subroutine check_scalars(props, num_rows, fault)
    real(rk), intent(in) :: props(:)
    integer, intent(in) :: num_rows(4)
    character(:), allocatable, intent(inout) :: fault
    integer :: i
    call require(props(1) > 0.0_rk, 1, 'E_0 > 0')
    call require(abs(props(2)) < 0.5_rk, 2, 'nu between -0.5 and 0.5')
    call require(props(3) > 0.0_rk .and. props(3) < 56.3_rk, 3, 'degrees between 0 and 56.3')
    call require(props(4) > 0.0_rk, 4, 'an offset > 0')
    call require(props(5) >= 1.0_rk, 5, 'f_b0/f_c0 >= 1')
    call require(props(6) > 0.5_rk .and. props(6) <= 1.0_rk, 6, 'K_c above 0.5, at most 1')
    call require(props(7) >= 0.0_rk, 7, 'a viscosity >= 0')
    call require(any(nint(props(8)) == [0, 1, 2]), 8, 'recovery 0, 1 or 2')
    call require(abs(props(9) - 0.5_rk) <= 0.5_rk, 9, 'w_t between 0 and 1')
    call require(abs(props(10) - 0.5_rk) <= 0.5_rk, 10, 'w_c between 0 and 1')
    call require(any(nint(props(11)) == [0, 1, 2]), 11, 'tension against 0, 1 or 2')
    call require(any(nint(props(12)) == [0, 1]), 12, 'tension damage against 0 or 1')
    call require(any(nint(props(13)) == [0, 1]), 13, 'long elements 0 or 1')
    call require(props(14) >= 0.0_rk, 14, 'a width >= 0')
    do i = 1, 4
      call require(num_rows(i) >= mod(i, 2), first_count + i - 1, 'a number of rows')
    end do
    if (len(fault) > 0) return
    if (size(props) /= num_scalars + 2*sum(num_rows)) then
      fault = as_text(size(props))//' constants; expected '// &
              as_text(num_scalars + 2*sum(num_rows))//' by the numbers of rows'
    end if

  contains

    !> Records the first fault.
    subroutine require(is_so, number, expected)
      logical, intent(in) :: is_so
      integer, intent(in) :: number !< of the constant
      character(*), intent(in) :: expected
      if (is_so .or. len(fault) > 0) return
      fault = 'constant '//as_text(number)//' is '//as_text(props(number))//'; expected '//expected
    end subroutine require
  end subroutine check_scalars

  !> Makes the model and the width of its crack band; `fault` as above.
  !>
  !> Scalars are checked in every call, tables on request. A check of tables in the first increment
  !> is enough, because an analysis stops there on a fault.
  subroutine make_model(props, celent, checks_tables, model, width, fault)
    real(rk), intent(in) :: props(:)
    real(rk), intent(in) :: celent !< of the caller [m]
    logical, intent(in) :: checks_tables
    type(concrete_model), intent(out) :: model
    real(rk), intent(out) :: width !< [m]
    character(:), allocatable, intent(out) :: fault
    type(concrete_constants) :: constants
    type(table_fault), allocatable :: faults(:)
    width = celent
    call read_constants(props, constants, fault)
    if (len(fault) > 0) return
    if (props(own_width) > 0.0_rk) width = props(own_width)
    if (checks_tables) then
      call find_table_faults(constants, faults)
      if (size(faults) > 0) then
        fault = 'table of '//faults(1)%keyword//', row '//as_text(faults(1)%row)//': '// &
                faults(1)%problem//'; expected '//faults(1)%expected
        return
      end if
    end if
    call make_concrete_model(constants, model)
    if (model%by_opening) call check_width(constants, model, width, fault)
  end subroutine make_model

  !> Checks the width for tables over openings.
  subroutine check_width(constants, model, width, fault)
    type(concrete_constants), intent(in) :: constants
    type(concrete_model), intent(in) :: model
    real(rk), intent(in) :: width !< [m]
    character(:), allocatable, intent(inout) :: fault
    type(table_fault) :: limit
    real(rk) :: longest
    if (.not. width > 0.0_rk) then
      fault = 'no width of the crack band: CELENT is not positive, nor is constant 14'
    else if (is_too_long(width, model%tension%longest) &
             .and. .not. constants%lowers_strength) then
      call find_longest_band(constants, longest, limit)
      fault = 'a crack band of '//as_text(width)//'; expected at most '//as_text(longest)// &
              ', '//limit%expected
    end if
  end subroutine check_width
end module umat_concrete
