!> job.json: the summary of a run. The file is complete at any time.
module summary_json
  use kinds, only: rk
  use errors, only: error_type
  use build_info, only: program_version, compiler, libraries
  use diagnostics, only: severity_ignored
  use diagnostic_text, only: headline
  use rank_balance, only: balance_of_ranks
  use rank_json, only: put_balance
  use run_ledger, only: ledger, ledger_part
  use timer, only: peak_memory
  use guest_list, only: guests_of_model
  use guest_type, only: guest_reference
  use problem_definition, only: problem
  use run_records, only: run_record
  use run_summaries, only: follows_error, run_summary, step_summary
  use json_writer, only: json_text, lower
  use error_json, only: put_estimates, put_increments
  use machine_json, only: put_machine
  use text_table, only: text_numbers
  use model_json, only: put_instances, put_model
  use joint_json, only: put_joints, put_interfaces, put_extremes
  use damage_json, only: put_damage
  use umat_json, only: put_umat
  use whole_files, only: write_over, write_whole_file
  implicit none
  private
  public :: write_summary

  character, parameter :: nl = new_line('a')

  !> Blanks at the end of the summary of a run that goes on: room for its last summary on a disk
  !> that is full by then.
  integer, parameter :: reserve = 8192
  !> Name and version of what job.json holds (docs/versions.md); names may be added in a version.
  character(*), parameter :: schema_name = 'keyway-job'
  integer, parameter :: schema_version = 1

contains

  !> Writes the file anew; on a full disk in its place, if it has the room.
  subroutine write_summary(path, model, summary, record, costs, error)
    character(*), intent(in) :: path
    type(problem), intent(in) :: model
    type(run_summary), intent(in) :: summary
    type(run_record), intent(in) :: record
    type(ledger), intent(in) :: costs
    type(error_type), allocatable, intent(out) :: error
    type(json_text) :: json
    character(:), allocatable :: text
    logical :: is_good
    call json%open_object()
    call put_schema(json)
    call put_program(json)
    call put_machine(json)
    call json%put_text(trim(summary%status), 'status')
    call json%put_text(summary%message, 'message')
    call json%open_object('deck')
    call json%put_text(model%deck_file, 'file')
    call json%put_text(summary%deck_digest, 'sha256')
    call json%close_object()
    call put_model(json, model, summary%num_unknowns)
    call put_instances(json, model)
    call put_effects(json, model)
    call put_interfaces(json, model)
    call put_remarks(json, summary, record)
    call put_steps(json, model, summary)
    call put_extremes(json, 'displacement', record%displacement)
    call put_envelopes(json, record)
    call put_joints(json, model, record)
    call put_damage(json, record%damage)
    call put_umat(json, model%umat)
    call put_accuracy(json, model, summary, record)
    call put_costs(json, costs, summary%balance)
    call put_files(json, record)
    call json%close_object()
    text = json%contents()
    if (summary%status == 'running') text = text//repeat(' ', reserve)//new_line('a')
    call write_whole_file(path, text, error)
    if (.not. allocated(error)) return
    call write_over(path, json%contents(), is_good)
    if (is_good) deallocate (error)
  end subroutine write_summary

  !> What the file holds, for readers that check it.
  subroutine put_schema(json)
    type(json_text), intent(inout) :: json
    call json%open_object('schema')
    call json%put_text(schema_name, 'name')
    call json%put_integer(schema_version, 'version')
    call json%close_object()
  end subroutine put_schema

  !> The program and its source version.
  subroutine put_program(json)
    type(json_text), intent(inout) :: json
    integer :: start, comma
    call json%open_object('program')
    call json%put_text('Keyway', 'name')
    call json%put_text(program_version, 'version')
    call json%put_text(compiler, 'compiler')
    call json%open_array('libraries')
    start = 1
    do while (start <= len(libraries))
      comma = index(libraries(start:)//',', ',')
      call json%put_text(trim(adjustl(libraries(start:start + comma - 2))))
      start = start + comma
    end do
    call json%close_array()
    call json%close_object()
  end subroutine put_program

  !> The guests of the model: loads, joints, springs, ties, inelastic materials, damping. A load has
  !> an entry of the model for each pattern of its forces, such as a level of water; it is listed
  !> once.
  subroutine put_effects(json, model)
    type(json_text), intent(inout) :: json
    type(problem), intent(in), target :: model
    type(guest_reference), allocatable :: guests(:)
    type(text_numbers) :: listed
    integer :: i
    call json%open_array('effects')
    do i = 1, size(model%loads)
      call put_effect(model%loads(i)%item%name, model%loads(i)%item%kind)
    end do
    call guests_of_model(model, guests)
    do i = 1, size(guests)
      call put_effect(guests(i)%item%name, guests(i)%item%kind)
    end do
    do i = 1, size(model%materials)
      if (is_inelastic(model, i)) call put_effect(model%materials(i)%name, 'inelastic')
      if (max(model%materials(i)%alpha, model%materials(i)%beta) > 0.0_rk) then
        call put_effect(model%materials(i)%name, 'damping')
      end if
    end do
    do i = 1, size(model%steps)
      associate (damping => model%steps(i)%damping)
        if (max(damping%ratio, damping%modal_ratio) > 0.0_rk) then
          call put_effect(model%steps(i)%name, 'damping')
        end if
      end associate
    end do
    call json%close_array()

  contains

    !> One guest, unless it is listed.
    subroutine put_effect(name, kind)
      character(*), intent(in) :: name, kind
      integer :: number
      if (listed%find(kind//nl//name) > 0) return
      call listed%find_or_add(kind//nl//name, number)
      call json%open_object()
      call json%put_text(name, 'name')
      call json%put_text(kind, 'kind')
      call json%close_object()
    end subroutine put_effect
  end subroutine put_effects

  !> Has a material of the model points with states?
  pure logical function is_inelastic(model, m)
    type(problem), intent(in) :: model
    integer, intent(in) :: m !< position of the material
    is_inelastic = .false.
    if (allocated(model%inelastic)) is_inelastic = any(model%inelastic%material == m)
  end function is_inelastic

  !> Ignored input, and the warnings of the deck and of the run.
  subroutine put_remarks(json, summary, record)
    type(json_text), intent(inout) :: json
    type(run_summary), intent(in) :: summary
    type(run_record), intent(in) :: record
    integer :: i
    call json%open_array('ignored_input')
    do i = 1, summary%remarks%num_warnings
      associate (remark => summary%remarks%warnings(i))
        if (remark%severity /= severity_ignored) cycle
        call json%open_object()
        call json%put_text(remark%spot%file, 'file')
        call json%put_integer(remark%spot%line, 'line')
        call json%put_text(remark%spot%keyword, 'keyword')
        call json%put_text(remark%problem, 'why')
        call json%close_object()
      end associate
    end do
    call json%close_array()
    call json%open_array('warnings')
    do i = 1, summary%remarks%num_warnings
      if (summary%remarks%warnings(i)%severity == severity_ignored) cycle
      call json%put_text(headline(summary%remarks%warnings(i)))
    end do
    do i = 1, size(record%warnings)
      call json%put_text(record%warnings(i)%text)
    end do
    call json%close_array()
  end subroutine put_remarks

  !> All steps that have started.
  subroutine put_steps(json, model, summary)
    type(json_text), intent(inout) :: json
    type(problem), intent(in) :: model
    type(run_summary), intent(in) :: summary
    integer :: i
    call json%open_array('steps')
    do i = 1, size(summary%steps)
      associate (part => summary%steps(i), plan => model%steps(summary%steps(i)%step))
        call json%open_object()
        call json%put_text(plan%name, 'name')
        call json%put_text(lower(trim(plan%procedure%name)), 'procedure')
        call json%put_real(part%time, 'time')
        call json%put_integer(part%increments, 'increments')
        call json%put_integer(part%iterations, 'iterations')
        call json%put_integer(part%cutbacks, 'cutbacks')
        call put_modes(json, part)
        call put_energy(json, part, model%stages%is_there_any(), model%heat%is_there_any())
        call json%close_object()
      end associate
    end do
    call json%close_array()
  end subroutine put_steps

  !> Frequencies of a step; an empty list for other steps.
  subroutine put_modes(json, part)
    type(json_text), intent(inout) :: json
    type(step_summary), intent(in) :: part
    integer :: i
    call json%open_array('frequencies')
    do i = 1, size(part%modes)
      call json%open_object()
      call json%put_integer(i, 'mode')
      call json%put_real(part%modes(i)%hz, 'hz')
      call json%put_reals(part%modes(i)%effective_mass, 'effective_mass')
      call json%close_object()
    end do
    call json%close_array()
  end subroutine put_modes

  !> Energies at the end of a step; the error is the largest in the step.
  subroutine put_energy(json, part, has_stages, has_heat)
    type(json_text), intent(inout) :: json
    type(step_summary), intent(in) :: part
    logical, intent(in) :: has_stages, has_heat
    call json%open_object('energy')
    call json%put_real(part%energy%external, 'external')
    call json%put_real(part%energy%kinetic, 'kinetic')
    call json%put_real(part%energy%strain, 'strain')
    call json%put_real(part%energy%damping, 'damping')
    call json%put_real(part%energy%friction, 'friction')
    call json%put_real(part%energy%fracture, 'fracture')
    call json%put_real(part%energy%crushing, 'crushing')
    call json%put_real(part%energy%numerical, 'numerical')
    if (has_stages) call json%put_real(part%energy%stages, 'stages')
    if (has_heat) call json%put_real(part%energy%temperature, 'temperature')
    call json%put_real(part%largest_error, 'error')
    call json%close_object()
  end subroutine put_energy

  !> Extremes of *ENVELOPE over all steps with the envelope.
  subroutine put_envelopes(json, record)
    type(json_text), intent(inout) :: json
    type(run_record), intent(in) :: record
    integer :: i
    call json%open_object('envelopes')
    do i = 1, size(record%envelopes)
      call put_extremes(json, trim(record%envelopes(i)%name), record%envelopes(i)%largest)
    end do
    call json%close_object()
  end subroutine put_envelopes

  !> Accuracy of the solution.
  subroutine put_accuracy(json, model, summary, record)
    type(json_text), intent(inout) :: json
    type(problem), intent(in) :: model
    type(run_summary), intent(in) :: summary
    type(run_record), intent(in) :: record
    call json%open_object('accuracy')
    call put_estimates(json, model, record)
    call json%put_real(maxval([0.0_rk, summary%steps%largest_residual]), 'largest_residual')
    call json%put_real(maxval([0.0_rk, summary%steps%largest_error]), 'largest_energy_error')
    call json%put_integer(maxval([0, summary%steps%most_iterations]), 'most_iterations')
    if (any(follows_error(summary%steps))) call put_increments(json, model, summary)
    if (any(summary%steps%reduction%num_modes > 0)) call put_reductions(json, model, summary)
    if (size(model%joints) > 0) call put_contact(json, model, summary, record)
    call json%close_object()
  end subroutine put_accuracy

  !> Reduced models: number of modes, highest frequency, error over the largest opening.
  subroutine put_reductions(json, model, summary)
    type(json_text), intent(inout) :: json
    type(problem), intent(in) :: model
    type(run_summary), intent(in) :: summary
    integer :: i
    call json%open_object('reduced')
    do i = 1, size(summary%steps)
      associate (part => summary%steps(i))
        if (part%reduction%num_modes == 0) cycle
        call json%open_object(model%steps(part%step)%name)
        call json%put_integer(part%reduction%num_modes, 'modes')
        call json%put_real(part%reduction%highest, 'highest_hz')
        if (part%reduction%estimate >= 0.0_rk) then
          call json%put_real(part%reduction%estimate, 'estimated_error')
          call json%put_real(model%steps(part%step)%reduced%accuracy, 'wanted')
        end if
        call json%close_object()
      end associate
    end do
    call json%close_object()
  end subroutine put_reductions

  !> Penetration of the joints compared with their opening, and the condition number of the
  !> equations with all joints closed.
  subroutine put_contact(json, model, summary, record)
    type(json_text), intent(inout) :: json
    type(problem), intent(in) :: model
    type(run_summary), intent(in) :: summary
    type(run_record), intent(in) :: record
    real(rk) :: opening
    integer :: j
    call json%put_real(maxval([0.0_rk, summary%steps%joint_condition]), 'joint_condition')
    call json%put_integer(sum([0, summary%steps%augmentations]), 'augmentations')
    call json%put_integer(maxval([0, summary%steps%most_augmentations]), 'most_augmentations')
    call json%open_object('joints')
    do j = 1, size(model%joints)
      opening = 0.0_rk
      if (record%joints(j)%opening%at(1)%is_found) opening = record%joints(j)%opening%at(1)%value
      call json%open_object(model%joints(j)%name)
      call json%put_real(record%joints(j)%penetration, 'largest_penetration')
      call json%put_real(opening, 'largest_opening')
      if (opening > 0.0_rk) then
        call json%put_real(record%joints(j)%penetration/opening, 'penetration_over_opening')
      end if
      call json%close_object()
    end do
    call json%close_object()
  end subroutine put_contact

  !> The ledger of time and memory.
  subroutine put_costs(json, costs, balance)
    type(json_text), intent(inout) :: json
    type(ledger), intent(in) :: costs
    type(balance_of_ranks), intent(in) :: balance
    type(ledger_part), allocatable :: parts(:)
    real(rk) :: wall_time
    integer :: i
    call costs%read_parts(parts, wall_time)
    call json%open_object('ledger')
    call json%put_real(wall_time, 'wall_s')
    call json%put_real(peak_memory(), 'peak_memory_mb')
    call json%open_array('parts')
    do i = 1, size(parts)
      call json%open_object()
      call json%put_text(parts(i)%name(), 'name')
      call json%put_text(parts(i)%kind, 'kind')
      call json%put_text(parts(i)%work, 'work')
      call json%put_text(parts(i)%effect, 'effect')
      call json%put_real(parts(i)%wall_time, 'wall_s')
      call json%put_real(parts(i)%memory, 'memory_mb')
      call json%put_integer(parts(i)%num_calls, 'calls')
      call json%close_object()
    end do
    call json%close_array()
    call put_balance(json, balance)
    call json%close_object()
  end subroutine put_costs

  !> Names of the files beside this one.
  subroutine put_files(json, record)
    type(json_text), intent(inout) :: json
    type(run_record), intent(in) :: record
    integer :: i
    call json%open_array('files')
    do i = 1, size(record%files)
      call json%put_text(record%files(i)%text)
    end do
    call json%close_array()
  end subroutine put_files
end module summary_json
