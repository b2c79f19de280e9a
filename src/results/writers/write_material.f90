!> job_material_NAME.csv: the curve of a material test, one row for the start and each increment.
module write_material
  use errors, only: error_type
  use kinds, only: rk
  use csv_files, only: csv_file
  use field_table, only: find_field, list_fields
  use field_type, only: by_law, result_field
  use material_law, only: stress_law
  use material_path, only: path_record
  use material_points, only: stored_energy, fracture_energy, crushing_energy
  use tensor6, only: principal_values
  use text_buffers, only: text_of
  implicit none
  private
  public :: write_curve

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
    call file%open(path, 'leg,increment,time,'//names// &
                   ',work,stored,fracture,crushing,iterations', error)
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

  !> The fields of the law besides strain and stress.
  subroutine collect_fields(law, record, names, values)
    class(stress_law), intent(in) :: law
    type(path_record), intent(in) :: record
    character(:), allocatable, intent(out) :: names !< of strain, stress and all `values`
    real(rk), allocatable, intent(out) :: values(:, :) !< (columns, rows)
    type(result_field), allocatable :: table(:)
    real(rk), allocatable :: field(:, :), longer(:, :)
    integer :: i, num
    call list_fields(table)
    names = table(find_field(table, 'E'))%columns(6)//','// &
            table(find_field(table, 'S'))%columns(6)//',S1,S2,S3'
    allocate (values(0, record%num_rows))
    do i = 1, size(table)
      if (table(i)%provider /= by_law) cycle
      call law%read_field(table(i)%name, record%state, field)
      if (.not. allocated(field)) cycle
      num = size(values, 1)
      allocate (longer(num + size(field, 1), record%num_rows))
      longer(:num, :) = values
      longer(num + 1:, :) = field
      call move_alloc(longer, values)
      names = names//','//table(i)%columns(size(field, 1))
    end do
  end subroutine collect_fields
end module write_material
