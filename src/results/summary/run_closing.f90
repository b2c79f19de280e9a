!> The end of a run in some lines for people: largest values with place and time, joints, damage,
!> accuracy, warnings, and what each effect has cost. The numbers are those of job.json.
module run_closing
  use damage_readings, only: damage_extreme, damage_record, levels
  use diagnostics, only: severity_ignored
  use dual_solutions, only: of_opening
  use error_words, only: error_of, error_of_envelope, error_of_motion, line_of_law, &
                         line_of_mesh, line_of_omissions
  use extremes, only: extreme
  use joint_points, only: dam_joint
  use joint_readings, only: gap_in_mesh
  use kinds, only: rk
  use problem_definition, only: problem
  use run_ledger, only: ledger, ledger_part
  use run_records, only: run_record
  use run_summaries, only: follows_error, run_summary
  use write_text, only: as_text, as_short_text
  implicit none
  private
  public :: closing_lines

  integer, parameter :: most_joints = 6, most_effects = 6, most_modes = 6 !< that are listed
  !> Least energy created by laws that is named, over the dissipated energy.
  real(rk), parameter :: least_created = 1.0e-3_rk
  character, parameter :: nl = new_line('a')

contains

  !> The lines, with new_line between them.
  function closing_lines(model, summary, record, costs) result(text)
    type(problem), intent(in) :: model
    type(run_summary), intent(in) :: summary
    type(run_record), intent(in) :: record
    type(ledger), intent(in) :: costs
    character(:), allocatable :: text
    text = 'results in the units of the deck:'
    if (record%displacement%at(1)%is_found) then
      text = text//nl//'largest displacement '// &
             described(record%displacement%at(1), model, summary)//error_of_motion(record)
    end if
    text = text//lines_of_modes(model, summary)//lines_of_envelopes(model, summary, record)// &
           lines_of_joints(model, summary, record)//lines_of_damage(model, summary, record)// &
           lines_of_accuracy(model, summary)//lines_of_increments(model, summary)// &
           line_of_mesh(record)//line_of_law(record)//line_of_omissions(model, summary, record)// &
           line_of_remarks(summary, record)//line_of_costs(costs)
  end function closing_lines

  !> Frequencies of each step that finds them.
  function lines_of_modes(model, summary) result(text)
    type(problem), intent(in) :: model
    type(run_summary), intent(in) :: summary
    character(:), allocatable :: text
    integer :: i, k
    text = ''
    do i = 1, size(summary%steps)
      associate (modes => summary%steps(i)%modes)
        if (size(modes) == 0) cycle
        text = text//nl//'frequencies of step '//model%steps(summary%steps(i)%step)%name//' [Hz]:'
        do k = 1, min(size(modes), most_modes)
          text = text//' '//as_short_text(modes(k)%hz)
        end do
        if (size(modes) > most_modes) text = text//' .. ('//as_text(size(modes))//' modes)'
      end associate
    end do
  end function lines_of_modes

  !> The extremes of *ENVELOPE, but those that have their own lines.
  function lines_of_envelopes(model, summary, record) result(text)
    type(problem), intent(in) :: model
    type(run_summary), intent(in) :: summary
    type(run_record), intent(in) :: record
    character(:), allocatable :: text
    integer :: i
    text = ''
    do i = 1, size(record%envelopes)
      associate (item => record%envelopes(i))
        if (any(item%name == [character(8) :: 'OPENING', 'U', 'DAMAGET', 'DAMAGEC'])) cycle
        if (.not. item%largest%at(1)%is_found) cycle
        text = text//nl//trim(merge('smallest', 'largest ', item%wants_smallest))//' '// &
               trim(item%name)//' '//described(item%largest%at(1), model, summary)// &
               error_of_envelope(model, item)
      end associate
    end do
  end function lines_of_envelopes

  !> Opening and slip of the joints that open most.
  function lines_of_joints(model, summary, record) result(text)
    type(problem), intent(in) :: model
    type(run_summary), intent(in) :: summary
    type(run_record), intent(in) :: record
    character(:), allocatable :: text
    logical :: is_left(size(record%joints))
    integer :: i, j
    text = ''
    is_left = .true.
    do i = 1, min(size(record%joints), most_joints)
      j = maxloc(record%joints%opening%at(1)%value, dim=1, mask=is_left)
      is_left(j) = .false.
      text = text//nl//model%joints(j)%name//': '
      associate (opening => record%joints(j)%opening%at(1), slip => record%joints(j)%slip%at(1))
        if (opening%is_found .and. opening%value > 0.0_rk) then
          text = text//'largest opening '//described(opening, model, summary)
          if (j == record%largest_opening()) then
            text = text//error_of(record%goals(of_opening), opening%value)
          end if
        else
          text = text//closed_text(model%joints(j))
        end if
        if (slip%is_found) text = text//', largest slip '//as_short_text(slip%value)
      end associate
    end do
    if (any(is_left)) text = text//nl//'the other '//as_text(count(is_left))//' joints open less'
  end function lines_of_joints

  !> 'never open', or what is left of a gap at the start.
  function closed_text(joint) result(text)
    type(dam_joint), intent(in) :: joint
    character(:), allocatable :: text
    real(rk) :: gap
    gap = gap_in_mesh(joint)
    text = 'never open'
    if (gap > 0.0_rk) text = 'open by up to '//as_short_text(gap)//' in the mesh, closed at '// &
                             'the end of all increments'
  end function closed_text

  !> Largest damage, damaged volume and dissipated energy.
  function lines_of_damage(model, summary, record) result(text)
    type(problem), intent(in) :: model
    type(run_summary), intent(in) :: summary
    type(run_record), intent(in) :: record
    character(:), allocatable :: text
    text = ''
    if (.not. record%damage%is_present) return
    text = line_of('tension', record%damage%tension, record%damage%cracking, 'cracked')// &
           line_of('compression', record%damage%compression, record%damage%crushing, &
                   'been crushed')
    text = text//nl//'volume with damage in tension of '//as_text(levels(2))//' or more '// &
           as_short_text(record%damage%volume(2))//'; dissipated by cracking '// &
           as_short_text(record%damage%cracking)//', by crushing '// &
           as_short_text(record%damage%crushing)//created_text(record%damage)
  contains
    !> One kind of damage. Concrete may crack without a damage variable: it keeps its stiffness.
    function line_of(kind, largest, energy, verb) result(line)
      character(*), intent(in) :: kind
      type(damage_extreme), intent(in) :: largest
      real(rk), intent(in) :: energy !< dissipated [J]
      character(*), intent(in) :: verb
      character(:), allocatable :: line
      line = nl//'no damage in '//kind
      if (energy > 0.0_rk) then
        line = nl//'damage in '//kind//' 0, though solids have '//verb//': see *CONCRETE '// &
               merge('TENSION    ', 'COMPRESSION', kind == 'tension')
        line = trim(line)//' DAMAGE'
      end if
      if (.not. largest%at%is_found) return
      line = nl//'largest damage in '//kind//' '//described(largest%at, model, summary)// &
             ', element '//as_text(largest%element)
    end function line_of
  end function lines_of_damage

  !> '; created by the law 2.9e6, 9 % of this': concrete whose stress has no potential.
  pure function created_text(damage) result(text)
    type(damage_record), intent(in) :: damage
    character(:), allocatable :: text
    real(rk) :: dissipated
    text = ''
    dissipated = damage%cracking + damage%crushing
    if (abs(damage%created) <= least_created*dissipated .or. .not. dissipated > 0.0_rk) return
    text = '; created by the law '//as_short_text(damage%created)//', '// &
           as_short_text(100.0_rk*damage%created/dissipated)//' % of this'
  end function created_text

  !> Iteration, energy balance, and the estimates of reduced models.
  function lines_of_accuracy(model, summary) result(text)
    type(problem), intent(in) :: model
    type(run_summary), intent(in) :: summary
    character(:), allocatable :: text
    character(13) :: measured ! by the estimate of a reduced model
    integer :: i
    text = ''
    if (sum([0, summary%steps%increments]) == 0) return
    measured = merge('openings     ', 'displacements', size(model%joints) > 0)
    associate (steps => summary%steps)
      text = nl//'error of the energy balance '// &
             as_short_text(maxval([0.0_rk, steps%largest_error]))//', residual '// &
             as_short_text(maxval([0.0_rk, steps%largest_residual]))//', at most '// &
             as_text(maxval([0, steps%most_iterations]))//' iterations in an increment, '// &
             as_text(sum([0, steps%cutbacks]))//' cut-backs'
      do i = 1, size(steps)
        if (steps(i)%reduction%num_modes == 0) cycle
        text = text//nl//'reduced model of step '//model%steps(steps(i)%step)%name//': '// &
               as_text(steps(i)%reduction%num_modes)//' modes'
        if (steps(i)%reduction%estimate < 0.0_rk) cycle
        text = text//', estimated error of '//trim(measured)//' '// &
               as_short_text(100.0_rk*steps(i)%reduction%estimate)//' % of the largest'
      end do
    end associate
  end function lines_of_accuracy

  !> Increments that have followed the estimated error, from the longest on.
  function lines_of_increments(model, summary) result(text)
    type(problem), intent(in) :: model
    type(run_summary), intent(in) :: summary
    character(:), allocatable :: text
    real(rk) :: below
    integer :: i, k, n
    text = ''
    do i = 1, size(summary%steps)
      associate (part => summary%steps(i))
        if (.not. follows_error(part)) cycle
        text = text//nl//'increments of step '//model%steps(part%step)%name//':'
        below = huge(1.0_rk)
        do n = 1, size(part%sizes)
          k = maxloc(part%sizes, dim=1, mask=part%sizes < below)
          below = part%sizes(k)
          if (n > 1) text = text//','
          text = text//' '//as_text(part%of_size(k))//' of '//as_short_text(part%sizes(k))//' s'
        end do
        if (size(model%joints) > 0 .and. part%energy%shows_impacts()) then
          text = text//'; error in time not known: impacts of joints take '// &
                 as_short_text(100.0_rk*part%energy%numerical/part%energy%largest)// &
                 ' % of the energy'
          cycle
        end if
        text = text//'; estimated error in time '// &
               as_short_text(100.0_rk*part%accuracy%relative())//' % of the largest displacement'
        if (part%accuracy%relative() > model%steps(part%step)%controls%accuracy) then
          text = text//', more than was asked for: name a smaller smallest increment'
        end if
      end associate
    end do
  end function lines_of_increments

  !> Numbers of warnings and ignored cards, if any.
  function line_of_remarks(summary, record) result(text)
    type(run_summary), intent(in) :: summary
    type(run_record), intent(in) :: record
    character(:), allocatable :: text
    integer :: num_warnings, num_ignored
    num_ignored = 0
    if (summary%remarks%num_warnings > 0) then
      num_ignored = count(summary%remarks%warnings(:summary%remarks%num_warnings)%severity == &
                          severity_ignored)
    end if
    num_warnings = summary%remarks%num_warnings - num_ignored + size(record%warnings)
    text = ''
    if (num_warnings + num_ignored == 0) return
    text = nl//'warnings: '//as_text(num_warnings)//', ignored cards: '//as_text(num_ignored)
  end function line_of_remarks

  !> The effects that have taken most of the time, with their shares.
  function line_of_costs(costs) result(text)
    type(ledger), intent(in) :: costs
    character(:), allocatable :: text
    type(ledger_part), allocatable :: parts(:)
    real(rk), allocatable :: time(:)
    real(rk) :: wall_time
    integer :: i, first, largest
    call costs%read_parts(parts, wall_time)
    allocate (time(size(parts)), source=0.0_rk)
    do i = 1, size(parts)
      do first = 1, i
        if (parts(first)%effect == parts(i)%effect) exit
      end do
      time(first) = time(first) + parts(i)%wall_time
    end do
    text = nl//'time:'
    do i = 1, min(size(parts), most_effects)
      largest = maxloc(time, dim=1)
      if (time(largest) < 0.005_rk*wall_time) exit
      if (i > 1) text = text//','
      text = text//' '//parts(largest)%effect//' '// &
             as_text(nint(100.0_rk*time(largest)/wall_time))//' %'
      time(largest) = -1.0_rk
    end do
  end function line_of_costs

  !> Value, place and time of an extreme.
  function described(found, model, summary) result(text)
    type(extreme), intent(in) :: found
    type(problem), intent(in) :: model
    type(run_summary), intent(in) :: summary
    character(:), allocatable :: text
    text = as_short_text(found%value)//' at ('//as_short_text(found%x(1))//', '// &
           as_short_text(found%x(2))//', '//as_short_text(found%x(3))//'), time '// &
           moment(found%time, model, summary)
  end function described

  !> A total time, and the time of its step where the run has several.
  function moment(time, model, summary) result(text)
    real(rk), intent(in) :: time !< total [s]
    type(problem), intent(in) :: model
    type(run_summary), intent(in) :: summary
    character(:), allocatable :: text
    real(rk) :: start
    integer :: i
    text = as_short_text(time)
    start = 0.0_rk
    do i = 1, size(summary%steps)
      if (i > 1 .and. time > start .and. time <= start + 1.000001_rk*summary%steps(i)%time) then
        text = text//' ('//model%steps(summary%steps(i)%step)%name//' '// &
               as_short_text(time - start)//')'
        return
      end if
      start = start + summary%steps(i)%time
    end do
  end function moment
end module run_closing
