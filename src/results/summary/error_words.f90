!> The estimated errors of results in words, for the lines at the end of a run.
module error_words
  use dual_solutions, only: of_displacement, of_opening
  use envelopes, only: envelope
  use goal_errors, only: cause_of_stray, goal_error
  use kinds, only: rk
  use place_errors, only: bounded_by_law, left_elasticity
  use problem_definition, only: problem
  use run_records, only: run_record
  use run_summaries, only: run_summary
  use singular_places, only: is_singular, words_of_cause
  use write_text, only: as_short_text, as_text
  implicit none
  private
  public :: error_of, error_of_envelope, error_of_motion, line_of_law, line_of_mesh
  public :: line_of_omissions

  real(rk), parameter :: smallest_part = 1.0e-3_rk !< of an error that is named, over all of it
  character, parameter :: nl = new_line('a')

contains

  !> The error of the largest displacement. With joints that in time is not known within a factor
  !> of 2 (theory.md, 14.3).
  function error_of_motion(record) result(text)
    type(run_record), intent(in) :: record
    character(:), allocatable :: text
    text = error_of(goal_of_motion(record), record%displacement%at(1)%value)
  end function error_of_motion

  !> What is known of the error of the largest displacement.
  pure type(goal_error) function goal_of_motion(record) result(found)
    type(run_record), intent(in) :: record
    found = record%goals(of_displacement)
    if (size(record%joints) > 0) found%at_time = 0.0_rk
  end function goal_of_motion

  !> ', +-0.0012 (time 0.0004, mesh 0.0008)': what is known of the error of a result.
  function error_of(found, value) result(text)
    type(goal_error), intent(in) :: found
    real(rk), intent(in) :: value !< [m]
    character(:), allocatable :: text, parts
    text = ''
    parts = ''
    if (found%is_stray(value)) then
      text = ', errors of increments and mesh not known: '//cause_of_stray
    end if
    if (found%has_time(value)) call add('time', found%time)
    if (found%has_mesh(value)) call add('mesh', found%mesh)
    if (found%has_joints(value)) call add('joints', found%joints)
    if (found%has_iteration(value)) call add('iteration', found%iteration)
    if (parts /= '') then
      text = text//', +-'//as_short_text(found%total(value))//' ('//parts(3:)
      if (.not. found%has_mesh(value)) text = text//'; mesh not estimated'
      text = text//')'
    end if
    if (found%is_soft(value)) then
      text = text//', springs of joints contribute about '//as_short_text(found%joints)
    end if
    if (found%history < 0.0_rk) return
    text = text//', histories +-'//as_short_text(100.0_rk*found%history)//' % (time)'
  contains
    !> Adds a part that matters.
    subroutine add(name, part)
      character(*), intent(in) :: name
      real(rk), intent(in) :: part !< [m]
      if (part >= smallest_part*found%total(value)) then
        parts = parts//', '//name//' '//as_short_text(part)
      end if
    end subroutine add
  end function error_of

  !> The error of the largest or smallest principal stress; '' where nothing is known.
  function error_of_envelope(model, item) result(text)
    type(problem), intent(in) :: model
    type(envelope), intent(in) :: item
    character(:), allocatable :: text
    text = ''
    if (item%error <= bounded_by_law) then
      text = ', a singular place ('//words_of_cause(item%cause)//'): the strength of the solid '// &
             'bounds the stress; values above the strength come from extrapolation to the '// &
             'node ('//trim(item%name)//'_POINT has the points)'
      return
    end if
    if (item%error <= left_elasticity) then
      text = ', error not known: the solid has left elasticity there'
      return
    end if
    if (is_singular(item%cause)) then
      text = ', a singular place ('//words_of_cause(item%cause)// &
             '): this stress grows with every refinement'
      return
    end if
    if (item%error < 0.0_rk) return
    text = ', +-'//as_short_text(item%error)//' (mesh'
    if (any(model%steps%procedure%has_inertia)) text = text//'; time not estimated'
    text = text//')'
  end function error_of_envelope

  !> What the mesh leaves in the stresses (theory.md, 14.1).
  function line_of_mesh(record) result(text)
    type(run_record), intent(in) :: record
    character(:), allocatable :: text
    text = ''
    if (record%space%stress <= 0.0_rk) return
    text = nl//'error of the mesh in the stresses: '// &
           as_short_text(100.0_rk*record%space%relative())//' % of all stresses together '// &
           '(energy norm), time '//as_short_text(record%space%time)
    if (record%space%elastic < 1.0_rk) then
      text = text//', in the solids that are elastic then, '// &
             as_short_text(100.0_rk*record%space%elastic)//' % of the volume of all solids'
    end if
  end function line_of_mesh

  !> What the laws of solids leave open within increments (theory.md, 14.7).
  function line_of_law(record) result(text)
    type(run_record), intent(in) :: record
    character(:), allocatable :: text
    text = ''
    if (record%path%num_points == 0) return
    text = nl//'error of the increments in the law of solids: '// &
           as_short_text(100.0_rk*record%path%relative())//' % of the dissipated energy, '// &
           'at most '//as_short_text(record%path%stress)//' in a stress ('// &
           as_text(record%path%num_points)//' points sampled)'
  end function line_of_law

  !> Results in the lines above whose error is not estimated, and what measures it.
  function line_of_omissions(model, summary, record) result(text)
    type(problem), intent(in) :: model
    type(run_summary), intent(in) :: summary
    type(run_record), intent(in) :: record
    character(:), allocatable :: text, names
    integer :: j
    text = ''
    names = ''
    if (.not. any(model%steps%controls%estimates_errors)) return
    if (record%displacement%at(1)%is_found) then
      call add('the largest displacement', goal_of_motion(record), record%displacement%at(1)%value)
    end if
    j = record%largest_opening()
    if (j > 0 .and. all(summary%steps%reduction%num_modes == 0 &
                        .or. summary%steps%reduction%estimate < 0.0_rk)) then
      call add('the largest opening', record%goals(of_opening), &
               record%joints(j)%opening%at(1)%value)
    end if
    if (any(record%joints%slip%at(1)%is_found)) then
      if (any(record%joints%slip%at(1)%value > 0.0_rk)) names = names//', slips'
    end if
    if (record%space%is_unknown()) names = names//', stresses'
    if (names == '') return
    text = nl//'errors not estimated: '//names(3:)//' (docs/accuracy.md); tools/accuracy '// &
           'measures them'
  contains
    !> Adds a result if nothing is known of its error.
    subroutine add(name, found, value)
      character(*), intent(in) :: name
      type(goal_error), intent(in) :: found
      real(rk), intent(in) :: value !< [m]
      if (value <= 0.0_rk .or. found%is_stray(value) .or. found%total(value) >= 0.0_rk) return
      names = names//', '//name
    end subroutine add
  end function line_of_omissions
end module error_words
