!> Keywords and parameters of other programs that have no effect here, each noted as ignored input,
!> and parameters that are refused.
module keywords_other
  use keyword_handler, only: keyword_list
  use keyword_spec, only: field, keyword, kind_text, without_effect
  implicit none
  private
  public :: add_ignored_keywords, add_idle_parameters, add_refused_parameter, shifted_history

  !> What takes the place of TIME DELAY.
  character(*), parameter :: shifted_history = 'AMPLITUDE with the delay added to its times'

contains

  !> Cards that ask Abaqus or CalculiX for output.
  subroutine add_ignored_keywords(list)
    type(keyword_list), intent(inout) :: list
    call add_ignored(list, 'CONTACT OUTPUT', 'Contact results. Joints: *JOINT PRINT, OPENING.')
    call add_ignored(list, 'CONTACT CONTROLS', 'Controls of the iteration of contact.')
    call add_ignored(list, 'CONTACT FILE', 'Contact results. Joints: *JOINT PRINT, OPENING.')
    call add_ignored(list, 'CONTACT PRINT', 'Contact results. Joints: *JOINT PRINT, OPENING.')
    call add_ignored(list, 'ENERGY OUTPUT', 'Energies. They are always in job_energy.csv.')
    call add_ignored(list, 'ENERGY PRINT', 'Energies. They are always in job_energy.csv.')
    call add_ignored(list, 'ENERGY FILE', 'Energies. They are always in job_energy.csv.')
    call add_ignored(list, 'SECTION PRINT', 'Forces of a section.')
    call add_ignored(list, 'SECTION FILE', 'Forces of a section.')
    call add_ignored(list, 'INCREMENTATION OUTPUT', 'Data of increments. They are in job.log.')
    call add_ignored(list, 'MODAL OUTPUT', 'Data of modes. They are in job.json.')
    call add_ignored(list, 'MODAL FILE', 'Data of modes. They are in job.json.')
    call add_ignored(list, 'SECTION CONTROLS', 'Hourglass control of Abaqus; C3D8R has its own.')
    call add_ignored(list, 'MONITOR', 'Watches one degree of freedom.')
    call add_ignored(list, 'PRINT', 'Chooses what Abaqus prints while it runs.')
    call add_ignored(list, 'FILE FORMAT', 'Format of the results file of Abaqus.')
    call add_ignored(list, 'TIME POINTS', 'Times of output.')
    call add_ignored(list, 'CONDUCTIVITY', 'Property of conduction.')
    call add_ignored(list, 'SPECIFIC HEAT', 'Property of conduction.')
    call add_ignored(list, 'FILE OUTPUT', 'Opens requests for the results file of Abaqus.')
    call add_ignored(list, 'SURFACE OUTPUT', 'Results of surfaces.')
    call add_ignored(list, 'INTEGRATED OUTPUT', 'Forces of a section.')
    call add_ignored(list, 'INTEGRATED OUTPUT SECTION', 'The section of *INTEGRATED OUTPUT.')
    call add_ignored(list, 'RADIATION OUTPUT', 'Results of radiation.')
    call add_ignored(list, 'DIAGNOSTICS', 'Messages of Abaqus.')
    call add_ignored(list, 'PHYSICAL CONSTANTS', 'Constants of radiation and gravitation.')
  end subroutine add_ignored_keywords

  !> Adds a keyword without effect.
  subroutine add_ignored(list, name, meaning)
    type(keyword_list), intent(inout) :: list
    character(*), intent(in) :: name, meaning
    list%num_keywords = list%num_keywords + 1
    associate (spec => list%specs(list%num_keywords))
      spec%name = name
      spec%family = 'other programs'
      spec%place = 'anywhere'
      spec%meaning = meaning
      spec%example = ''
      spec%status = without_effect
      allocate (spec%parameters(0), spec%columns(0))
    end associate
  end subroutine add_ignored

  !> Adds parameters of other programs that are noted as ignored input.
  subroutine add_idle_parameters(spec, names)
    type(keyword), intent(inout) :: spec
    character(*), intent(in) :: names(:)
    type(field), allocatable :: longer(:)
    integer :: i, n
    call copy_with_room(spec, size(names), longer, n)
    do i = 1, size(names)
      longer(n + i)%name = trim(names(i))
      longer(n + i)%kind = kind_text
      longer(n + i)%meaning = 'has no effect here'
      longer(n + i)%has_no_effect = .true.
    end do
    call move_alloc(longer, spec%parameters)
  end subroutine add_idle_parameters

  !> Adds a parameter of other programs that is an error, with what to take instead.
  subroutine add_refused_parameter(spec, name, instead)
    type(keyword), intent(inout) :: spec
    character(*), intent(in) :: name, instead
    type(field), allocatable :: longer(:)
    integer :: n
    call copy_with_room(spec, 1, longer, n)
    longer(n + 1)%name = name
    longer(n + 1)%kind = kind_text
    longer(n + 1)%meaning = 'refused; take instead: '//instead
    longer(n + 1)%may_be_bare = .true.
    longer(n + 1)%instead = instead
    call move_alloc(longer, spec%parameters)
  end subroutine add_refused_parameter

  !> The parameters of a keyword, with room for more behind them.
  subroutine copy_with_room(spec, num_more, longer, num_old)
    type(keyword), intent(in) :: spec
    integer, intent(in) :: num_more
    type(field), allocatable, intent(out) :: longer(:)
    integer, intent(out) :: num_old
    integer :: i
    num_old = 0
    if (allocated(spec%parameters)) num_old = size(spec%parameters)
    allocate (longer(num_old + num_more))
    do i = 1, num_old
      longer(i) = spec%parameters(i)
    end do
  end subroutine copy_with_room
end module keywords_other
