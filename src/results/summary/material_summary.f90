!> Summary of material tests: extremes and energies, for job_material.json and the terminal.
module material_summary
  use build_info, only: program_version
  use errors, only: error_type
  use json_writer, only: json_text
  use kinds, only: rk
  use material_path, only: path_record
  use material_points, only: stored_energy, fracture_energy, crushing_energy
  use material_tests, only: material_test
  use tensor6, only: principal_values
  use whole_files, only: write_whole_file
  implicit none
  private
  public :: test_summary, summarise_test, table_of_tests, write_test_summary

  character, parameter :: nl = new_line('a')
  character(3), parameter :: stress_names(6) = ['S11', 'S22', 'S33', 'S12', 'S13', 'S23']

  !> A stress with strain of the same component and time.
  type :: peak
    real(rk) :: stress = 0.0_rk, strain = 0.0_rk, time = 0.0_rk
  end type peak

  type :: test_summary
    character(:), allocatable :: name, kind, material, message, file
    logical :: has_finished = .false.
    real(rk) :: length = 0.0_rk !< [m]
    real(rk) :: time = 0.0_rk !< duration of the test [s]
    integer :: rows = 0, iterations = 0
    integer :: component = 1 !< of the peaks
    type(peak) :: largest, smallest
    real(rk) :: largest_principal = 0.0_rk, smallest_principal = 0.0_rk !< [Pa]
    real(rk) :: work = 0.0_rk, stored = 0.0_rk, fracture = 0.0_rk, crushing = 0.0_rk !< [J/m3]
  end type test_summary

contains

  !> Computes the summary from the record of a test.
  subroutine summarise_test(test, material, record, summary)
    type(material_test), intent(in) :: test
    character(*), intent(in) :: material !< name
    type(path_record), intent(in) :: record
    type(test_summary), intent(out) :: summary
    real(rk) :: principal(3)
    integer :: i
    summary%name = test%name
    summary%kind = test%kind
    summary%material = material
    summary%message = ''
    summary%length = test%length
    summary%rows = record%num_rows
    summary%iterations = sum(record%iterations)
    associate (state => record%state, last => record%num_rows)
      summary%component = test%driven
      if (test%driven == 0) then
        summary%component = maxloc(maxval(state%stress, 2) - minval(state%stress, 2), 1)
      end if
      summary%largest = peak_at(maxloc(state%stress(summary%component, :), 1))
      summary%smallest = peak_at(minloc(state%stress(summary%component, :), 1))
      do i = 1, last
        principal = principal_values(state%stress(:, i))
        summary%largest_principal = max(summary%largest_principal, principal(1))
        summary%smallest_principal = min(summary%smallest_principal, principal(3))
      end do
      summary%time = record%time(last)
      summary%work = record%work(last)
      summary%stored = state%energy(stored_energy, last)
      summary%fracture = state%energy(fracture_energy, last)
      summary%crushing = state%energy(crushing_energy, last)
    end associate

  contains

    !> The chosen component in a row.
    pure type(peak) function peak_at(row)
      integer, intent(in) :: row
      peak_at%stress = record%state%stress(summary%component, row)
      peak_at%strain = record%state%strain(summary%component, row)
      peak_at%time = record%time(row)
    end function peak_at
  end subroutine summarise_test

  !> A line for each test.
  function table_of_tests(tests) result(text)
    type(test_summary), intent(in) :: tests(:)
    character(:), allocatable :: text
    character(20) :: name
    integer :: i
    text = 'test                 of      largest  at strain     smallest  at strain'// &
           '         work   dissipated'
    do i = 1, size(tests)
      associate (now => tests(i))
        name = now%name
        text = text//nl//name//' '//stress_names(now%component)//columns_of(now%largest)// &
               columns_of(now%smallest)//column('(es13.5e3)', now%work)// &
               column('(es13.5e3)', now%fracture + now%crushing)
        if (.not. now%has_finished) text = text//'  stopped'
      end associate
    end do
    text = text//nl//'stress [Pa] of the component that is driven; work and dissipated [J/m3]'
  end function table_of_tests

  !> Stress and strain of a peak in the table.
  pure function columns_of(top) result(text)
    type(peak), intent(in) :: top
    character(:), allocatable :: text
    text = column('(es13.5e3)', top%stress)//column('(es11.3e3)', top%strain)
  end function columns_of

  !> A number with an exponent of two digits, or of three: Fortran itself leaves out the E then.
  pure function column(form, number) result(text)
    character(*), intent(in) :: form !< (esW.De3), W two digits
    real(rk), intent(in) :: number
    character(:), allocatable :: text
    integer :: width, i
    read (form(4:5), *) width
    allocate (character(width) :: text)
    write (text, form) number
    i = index(text, 'E') + 2 ! first digit of the exponent
    if (i > 2) then
      if (text(i:i) == '0') text = ' '//text(:i - 1)//text(i + 1:)
    end if
  end function column

  !> Writes job_material.json.
  subroutine write_test_summary(path, deck, tests, error)
    character(*), intent(in) :: path, deck !< name of the file; name of the deck as given
    type(test_summary), intent(in) :: tests(:)
    type(error_type), allocatable, intent(out) :: error
    type(json_text) :: json
    integer :: i
    call json%open_object()
    call json%open_object('program')
    call json%put_text('Keyway', 'name')
    call json%put_text(program_version, 'version')
    call json%close_object()
    call json%put_text(status_of(all(tests%has_finished)), 'status')
    call json%put_text(deck, 'deck')
    call json%open_object('tests')
    do i = 1, size(tests)
      call put_test(json, tests(i))
    end do
    call json%close_object()
    call json%close_object()
    call write_whole_file(path, json%contents(), error)
  end subroutine write_test_summary

  !> One test.
  subroutine put_test(json, test)
    type(json_text), intent(inout) :: json
    type(test_summary), intent(in) :: test
    call json%open_object(test%name)
    call json%put_text(status_of(test%has_finished), 'status')
    call json%put_text(test%message, 'message')
    call json%put_text(test%kind, 'type')
    call json%put_text(test%material, 'material')
    call json%put_text(test%file, 'file')
    call json%put_real(test%length, 'length')
    call json%put_real(test%time, 'time')
    call json%put_integer(test%rows, 'rows')
    call json%put_integer(test%iterations, 'iterations')
    call json%put_text(stress_names(test%component), 'component')
    call put_peak(json, 'largest', test%largest)
    call put_peak(json, 'smallest', test%smallest)
    call json%put_real(test%largest_principal, 'S1')
    call json%put_real(test%smallest_principal, 'S3')
    call json%open_object('energy')
    call json%put_real(test%work, 'work')
    call json%put_real(test%stored, 'stored')
    call json%put_real(test%fracture, 'fracture')
    call json%put_real(test%crushing, 'crushing')
    call json%close_object()
    call json%close_object()
  end subroutine put_test

  subroutine put_peak(json, key, top)
    type(json_text), intent(inout) :: json
    character(*), intent(in) :: key
    type(peak), intent(in) :: top
    call json%open_object(key)
    call json%put_real(top%stress, 'stress')
    call json%put_real(top%strain, 'strain')
    call json%put_real(top%time, 'time')
    call json%close_object()
  end subroutine put_peak

  !> 'finished' or 'stopped'.
  pure function status_of(has_finished) result(text)
    logical, intent(in) :: has_finished
    character(:), allocatable :: text
    text = trim(merge('finished', 'stopped ', has_finished))
  end function status_of
end module material_summary
