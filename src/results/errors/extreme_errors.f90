!> The error of the mesh in the extreme of an envelope of S1 or S3, kept up to date while the
!> extreme grows (theory.md, 14.6).
module extreme_errors
  use analysis_state, only: state
  use envelopes, only: envelope
  use extremes, only: extreme
  use kinds, only: rk
  use material_damage_plasticity, only: concrete_law
  use place_errors, only: bounded_by_law, error_at_node, left_elasticity, not_known
  use problem_definition, only: problem
  use singular_places, only: is_singular, singular_nodes
  use stress_fields, only: recovered_fields
  implicit none
  private
  public :: forget_error, update_error

  !> Of an extreme at its place, for which its error is scaled with it. The scaled error is that of
  !> a stress field up to this part smaller, much nearer than any estimate is to the true error.
  real(rk), parameter :: small_growth = 0.05_rk

contains

  !> No error is estimated.
  pure subroutine forget_error(item)
    type(envelope), intent(inout) :: item
    item%error = not_known
    item%cause = 0
  end subroutine forget_error

  !> The error of an extreme that has grown. At a singular place there is none to find, but whether
  !> inelastic solids have cracked there.
  subroutine update_error(model, now, stresses, singular, node, before, item)
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    type(recovered_fields), intent(inout) :: stresses !< of this increment
    type(singular_nodes), intent(inout) :: singular
    integer, intent(in) :: node !< of the extreme
    type(extreme), intent(in) :: before !< the extreme that has been exceeded
    type(envelope), intent(inout) :: item
    item%cause = singular%cause_at(model, node)
    if (is_singular(item%cause) .and. .not. has_inelastic(model)) then
      item%error = not_known
    else if (has_grown_little(model, before, item)) then
      item%error = item%error*item%largest%at(1)%value/before%value
    else
      item%error = error_at_node(model, now, stresses, node, merge(3, 1, item%wants_smallest))
      item%found_at = item%largest%at(1)%value
      if (.not. is_singular(item%cause) .or. item%error <= left_elasticity) return
      if (is_bounded(model, node)) item%error = bounded_by_law
    end if
  end subroutine update_error

  !> Whether all solids at a node are of concrete, which has a strength in tension and compression.
  logical function is_bounded(model, node)
    type(problem), intent(in) :: model
    integer, intent(in) :: node
    integer :: e, m
    is_bounded = .false.
    do e = 1, model%mesh%num_elements
      m = model%mesh%material_of_element(e)
      if (m == 0) cycle
      if (.not. any(model%mesh%nodes(:, e) == node)) cycle
      select type (law => model%materials(m)%law)
      type is (concrete_law)
        is_bounded = .true.
      class default
        is_bounded = .false.
        return
      end select
    end do
  end function is_bounded

  !> Whether an extreme has grown at its place by little since its error was found.
  pure logical function has_grown_little(model, before, item) result(is_near)
    type(problem), intent(in) :: model
    type(extreme), intent(in) :: before
    type(envelope), intent(in) :: item
    is_near = .false.
    if (has_inelastic(model) .or. item%error <= 0.0_rk) return
    associate (now => item%largest%at(1))
      is_near = all(abs(now%x - before%x) <= 0.0_rk) .and. &
                abs(now%value - item%found_at) <= small_growth*abs(item%found_at)
    end associate
  end function has_grown_little

  !> Whether solids can leave elasticity.
  pure logical function has_inelastic(model)
    type(problem), intent(in) :: model
    has_inelastic = .false.
    if (allocated(model%inelastic)) has_inelastic = size(model%inelastic) > 0
  end function has_inelastic
end module extreme_errors
