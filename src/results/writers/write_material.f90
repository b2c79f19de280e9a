!> job_material_NAME.csv: the curve of a material test, one row for the start and each increment.
module write_material
  use errors, only: error_type
  use kinds, only: rk
  use csv_files, only: csv_file
  use material_law, only: stress_law
  use material_path, only: path_record
  use material_points, only: stored_energy, fracture_energy, crushing_energy
  use tensor6, only: principal_values
  use text_buffers, only: text_of
  implicit none
  private
  public :: write_curve

  character(2), parameter :: components(6) = ['11', '22', '33', '12', '13', '23']
  character(8), parameter :: fields(4) = [character(8) :: 'PE', 'DAMAGET', 'DAMAGEC', 'SDV']

contains

  !> Writes the file.
  subroutine write_curve(path, law, record, error)
    character(*), intent(in) :: path
    class(stress_law), intent(in) :: law
    type(path_record), intent(in) :: record
    type(error_type), allocatable, intent(out) :: error
    type(csv_file) :: file
    character(:), allocatable :: names
    real(rk), allocatable :: extra(:, :)
    integer :: i, row
    call collect_fields(law, record, names, extra)
    call file%open(path, 'leg,increment,time'//tensor_names('E')//tensor_names('S')// &
                   ',S1,S2,S3'//names//',work,stored,fracture,crushing,iterations', error)
    if (allocated(error)) return
    associate (state => record%state, lines => file%lines)
      do row = 1, record%num_rows
        call lines%add_integer(record%leg(row))
        call lines%add(',')
        call lines%add_integer(record%increment(row))
        associate (numbers => [record%time(row), state%strain(:, row), state%stress(:, row), &
                               principal_values(state%stress(:, row)), extra(:, row), &
                               record%work(row), state%energy(stored_energy, row), &
                               state%energy(fracture_energy, row), &
                               state%energy(crushing_energy, row)])
          do i = 1, size(numbers)
            call lines%add(',')
            call lines%add_real(numbers(i))
          end do
        end associate
        call lines%add(','//text_of(record%iterations(row))//new_line('a'))
      end do
    end associate
    call file%save(error)
    if (.not. allocated(error)) call file%close(error)
  end subroutine write_curve

  !> What the law keeps besides strain and stress: only fields that it has.
  subroutine collect_fields(law, record, names, values)
    class(stress_law), intent(in) :: law
    type(path_record), intent(in) :: record
    character(:), allocatable, intent(out) :: names !< ',PE11,PE22,...'
    real(rk), allocatable, intent(out) :: values(:, :) !< (columns, rows)
    real(rk), allocatable :: field(:, :), longer(:, :)
    integer :: i, k, num
    names = ''
    allocate (values(0, record%num_rows))
    do i = 1, size(fields)
      call law%read_field(trim(fields(i)), record%state, field)
      if (.not. allocated(field)) cycle
      num = size(values, 1)
      allocate (longer(num + size(field, 1), record%num_rows))
      longer(:num, :) = values
      longer(num + 1:, :) = field
      call move_alloc(longer, values)
      if (fields(i) == 'PE') then
        names = names//tensor_names('PE')
      else if (fields(i) == 'SDV') then
        do k = 1, size(field, 1)
          names = names//',SDV'//text_of(k)
        end do
      else
        names = names//','//trim(fields(i))
      end if
    end do
  end subroutine collect_fields

  !> ',E11,E22,E33,E12,E13,E23'
  pure function tensor_names(letters) result(names)
    character(*), intent(in) :: letters
    character(:), allocatable :: names
    integer :: i
    names = ''
    do i = 1, size(components)
      names = names//','//letters//components(i)
    end do
  end function tensor_names
end module write_material
