!> The errors that a run estimates, in job.json (theory.md, 14).
module error_json
  use kinds, only: rk
  use dual_solutions, only: of_displacement, of_opening
  use goal_errors, only: cause_of_stray, goal_error
  use place_errors, only: bounded_by_law, left_elasticity, not_known
  use singular_places, only: is_singular, words_of_cause
  use json_writer, only: json_text
  use problem_definition, only: problem
  use run_records, only: run_record
  use run_summaries, only: follows_error, run_summary
  implicit none
  private
  public :: put_estimates, put_increments

contains

  !> The object `estimates` of `accuracy`: what is not estimated is left out.
  subroutine put_estimates(json, model, record)
    type(json_text), intent(inout) :: json
    type(problem), intent(in) :: model
    type(run_record), intent(in) :: record
    call json%open_object('estimates')
    call put_stress(json, record)
    call put_extremes(json, record)
    call put_law(json, record)
    call put_displacement(json, record)
    call put_opening(json, model, record)
    call json%close_object()
  end subroutine put_estimates

  !> Steps whose increments follow the estimated error: the error over the largest displacement, and
  !> how many increments have which size.
  subroutine put_increments(json, model, summary)
    type(json_text), intent(inout) :: json
    type(problem), intent(in) :: model
    type(run_summary), intent(in) :: summary
    integer :: i, k
    call json%open_object('increments')
    do i = 1, size(summary%steps)
      associate (part => summary%steps(i))
        if (.not. follows_error(part)) cycle
        call json%open_object(model%steps(part%step)%name)
        call json%put_real(model%steps(part%step)%controls%accuracy, 'wanted')
        if (size(model%joints) > 0 .and. part%energy%shows_impacts()) then
          call json%put_text('impacts of joints take much of the energy', 'not_known')
        else
          call json%put_real(part%accuracy%relative(), 'estimated_error')
        end if
        call json%open_array('sizes')
        do k = 1, size(part%sizes)
          call json%open_object()
          call json%put_real(part%sizes(k), 'size')
          call json%put_integer(part%of_size(k), 'increments')
          call json%close_object()
        end do
        call json%close_array()
        call json%close_object()
      end associate
    end do
    call json%close_object()
  end subroutine put_increments

  !> The largest displacement. With joints the error in time of the extreme is not known within a
  !> factor of 2 (theory.md, 14.3).
  subroutine put_displacement(json, record)
    type(json_text), intent(inout) :: json
    type(run_record), intent(in) :: record
    type(goal_error) :: found
    found = record%goals(of_displacement)
    if (size(record%joints) > 0) found%at_time = 0.0_rk
    if (.not. record%displacement%at(1)%is_found) return
    call put_goal(json, 'displacement', record%displacement%at(1)%value, '', found)
  end subroutine put_displacement

  !> The largest opening of all joints.
  subroutine put_opening(json, model, record)
    type(json_text), intent(inout) :: json
    type(problem), intent(in) :: model
    type(run_record), intent(in) :: record
    integer :: j
    j = record%largest_opening()
    if (j == 0) return
    call put_goal(json, 'opening', record%joints(j)%opening%at(1)%value, model%joints(j)%name, &
                  record%goals(of_opening))
  end subroutine put_opening

  !> A result and the parts of its error, if any is known; `history` is relative.
  subroutine put_goal(json, name, value, joint, found)
    type(json_text), intent(inout) :: json
    character(*), intent(in) :: name, joint
    real(rk), intent(in) :: value !< [m]
    type(goal_error), intent(in) :: found
    if (found%total(value) < 0.0_rk .and. found%history < 0.0_rk .and. &
        .not. found%is_stray(value)) return
    call json%open_object(name)
    call json%put_real(value, 'value')
    if (joint /= '') call json%put_text(joint, 'joint')
    if (found%total(value) >= 0.0_rk) call json%put_real(found%total(value), 'error')
    if (found%is_stray(value)) then
      call json%put_text('time, mesh: '//cause_of_stray, 'not_known')
    end if
    if (found%has_time(value)) call json%put_real(found%time, 'time')
    if (found%has_mesh(value)) call json%put_real(found%mesh, 'mesh')
    if (found%has_joints(value)) call json%put_real(found%joints, 'joints')
    if (found%is_soft(value)) call json%put_real(found%joints, 'springs')
    if (found%has_iteration(value)) call json%put_real(found%iteration, 'iteration')
    if (found%history >= 0.0_rk) call json%put_real(found%history, 'history')
    call json%close_object()
  end subroutine put_goal

  !> Energy norms of the stresses and of the error of the mesh.
  subroutine put_stress(json, record)
    type(json_text), intent(inout) :: json
    type(run_record), intent(in) :: record
    if (record%space%stress <= 0.0_rk) return
    call json%open_object('stress')
    call json%put_real(record%space%stress, 'value')
    call json%put_real(record%space%error, 'error')
    call json%put_real(record%space%error, 'mesh')
    call json%put_real(record%space%relative(), 'relative')
    call json%put_real(record%space%time, 'at')
    call json%put_real(record%space%elastic, 'elastic_volume')
    call json%close_object()
  end subroutine put_stress

  !> What the laws of solids leave open within increments.
  subroutine put_law(json, record)
    type(json_text), intent(inout) :: json
    type(run_record), intent(in) :: record
    if (record%path%num_points == 0) return
    call json%open_object('law')
    call json%put_real(record%damage%cracking + record%damage%crushing, 'value')
    call json%put_real(record%path%relative(), 'relative')
    call json%put_real(record%path%stress, 'stress')
    call json%put_integer(record%path%num_points, 'points')
    call json%close_object()
  end subroutine put_law

  !> The largest and the smallest principal stress of *ENVELOPE; a singular place has no error.
  subroutine put_extremes(json, record)
    type(json_text), intent(inout) :: json
    type(run_record), intent(in) :: record
    integer :: i
    do i = 1, size(record%envelopes)
      associate (item => record%envelopes(i))
        if (item%error <= not_known .and. item%error > left_elasticity &
            .and. .not. is_singular(item%cause)) cycle
        call json%open_object(trim(item%name))
        call json%put_real(item%largest%at(1)%value, 'value')
        if (item%error <= bounded_by_law) then
          call json%put_text('a singular place, where the law of the solid bounds the stress', &
                             'not_known')
        else if (item%error <= left_elasticity) then
          call json%put_text('the solid has left elasticity', 'not_known')
        else if (is_singular(item%cause)) then
          call json%put_text(words_of_cause(item%cause), 'singular')
        else
          call json%put_real(item%error, 'error')
          call json%put_real(item%error, 'mesh')
        end if
        call json%close_object()
      end associate
    end do
  end subroutine put_extremes
end module error_json
