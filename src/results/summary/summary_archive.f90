!> Saves and loads the summary of a run: what job.json says of the steps.
!> tests/tools/test_archives.py compares the procedures with the types.
module summary_archive
  use archive_type, only: archive
  use energy_archive, only: load_energy, save_energy
  use errors, only: error_type
  use kinds, only: rk
  use run_summaries, only: run_summary, step_summary
  use state_archive, only: load_accuracy, load_reduction, save_accuracy, save_reduction
  use write_text, only: as_text
  implicit none
  private
  public :: save_summary, load_summary

contains

  !> Writes the summary into the group `summary`.
  subroutine save_summary(summary, file, error)
    type(run_summary), intent(in) :: summary
    class(archive), intent(inout) :: file !< open for writing
    type(error_type), allocatable, intent(out) :: error
    integer :: i
    call file%open_group('summary')
    call file%put('num_unknowns', summary%num_unknowns)
    call file%put('num_steps', size(summary%steps))
    do i = 1, size(summary%steps)
      call file%open_group('step_'//as_text(i))
      call save_step(summary%steps(i), file)
      call file%close_group()
    end do
    call file%close_group()
    call file%report(error)
  end subroutine save_summary

  !> Reads the summary; what comes from the deck stays.
  subroutine load_summary(summary, file, error)
    type(run_summary), intent(inout) :: summary
    class(archive), intent(inout) :: file !< open for reading
    type(error_type), allocatable, intent(out) :: error
    integer :: i, num_steps
    num_steps = 0
    call file%open_group('summary')
    call file%get('num_unknowns', summary%num_unknowns)
    call file%get('num_steps', num_steps)
    if (allocated(summary%steps)) deallocate (summary%steps)
    allocate (summary%steps(num_steps))
    do i = 1, num_steps
      call file%open_group('step_'//as_text(i))
      call load_step(summary%steps(i), file)
      call file%close_group()
    end do
    call file%close_group()
    call file%report(error)
  end subroutine load_summary

  !> Writes the summary of a step.
  subroutine save_step(part, file)
    type(step_summary), intent(in) :: part
    class(archive), intent(inout) :: file
    integer :: i
    call file%put('step', part%step)
    call file%put('time', part%time)
    call file%put('increments', part%increments)
    call file%put('iterations', part%iterations)
    call file%put('cutbacks', part%cutbacks)
    call file%put('most_iterations', part%most_iterations)
    call file%put('augmentations', part%augmentations)
    call file%put('most_augmentations', part%most_augmentations)
    call file%put('joint_condition', part%joint_condition)
    call file%put('largest_residual', part%largest_residual)
    call file%put('largest_error', part%largest_error)
    call file%open_group('energy')
    call save_energy(part%energy, file)
    call file%close_group()
    call file%open_group('reduction')
    call save_reduction(part%reduction, file)
    call file%close_group()
    call file%open_group('accuracy')
    call save_accuracy(part%accuracy, file)
    call file%close_group()
    call file%put('sizes', part%sizes)
    call file%put('of_size', part%of_size)
    call file%put('num_modes', size(part%modes))
    do i = 1, size(part%modes)
      call file%put('hz_'//as_text(i), part%modes(i)%hz)
      call file%put('effective_mass_'//as_text(i), as_list(part%modes(i)%effective_mass))
    end do
  end subroutine save_step

  !> Reads the summary of a step.
  subroutine load_step(part, file)
    type(step_summary), intent(inout) :: part
    class(archive), intent(inout) :: file
    integer :: i, num_modes
    num_modes = 0
    call file%get('step', part%step)
    call file%get('time', part%time)
    call file%get('increments', part%increments)
    call file%get('iterations', part%iterations)
    call file%get('cutbacks', part%cutbacks)
    call file%get('most_iterations', part%most_iterations)
    call file%get('augmentations', part%augmentations)
    call file%get('most_augmentations', part%most_augmentations)
    call file%get('joint_condition', part%joint_condition)
    call file%get('largest_residual', part%largest_residual)
    call file%get('largest_error', part%largest_error)
    call file%open_group('energy')
    call load_energy(part%energy, file)
    call file%close_group()
    call file%open_group('reduction')
    call load_reduction(part%reduction, file)
    call file%close_group()
    call file%open_group('accuracy')
    call load_accuracy(part%accuracy, file)
    call file%close_group()
    call file%get('sizes', part%sizes)
    call file%get('of_size', part%of_size)
    call file%get('num_modes', num_modes)
    allocate (part%modes(num_modes))
    do i = 1, num_modes
      call file%get('hz_'//as_text(i), part%modes(i)%hz)
      call load_mass('effective_mass_'//as_text(i))
      if (file%has_failed()) return
    end do

  contains

    !> The effective mass of a mode.
    subroutine load_mass(name)
      character(*), intent(in) :: name
      real(rk), allocatable :: mass(:)
      allocate (mass(size(part%modes(i)%effective_mass)), source=0.0_rk)
      call file%get(name, mass)
      if (allocated(mass)) part%modes(i)%effective_mass = mass
    end subroutine load_mass
  end subroutine load_step

  !> A copy that can be stored.
  pure function as_list(values) result(list)
    real(rk), intent(in) :: values(:)
    real(rk), allocatable :: list(:)
    list = values
  end function as_list
end module summary_archive
