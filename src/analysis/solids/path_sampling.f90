!> Repeats the path of sampled points over an increment in two halves: what the law leaves open
!> within the increment (theory.md, 14.7).
module path_sampling
  use kinds, only: rk
  use inelastic_blocks, only: inelastic_block
  use material_law, only: stress_law
  use material_points, only: crushing_energy, fracture_energy, no_tangent, point_set, point_state, &
                             time_increment, update_report
  use path_errors, only: path_error
  use problem_definition, only: problem
  implicit none
  private
  public :: sample_paths

  !> One of so many points that have dissipated is repeated: two calls of the law for fifty points,
  !> each of which the iteration has updated several times.
  integer, parameter :: stride = 50

contains

  !> Adds the sampled points of an increment that was accepted.
  subroutine sample_paths(model, time, old, new, path)
    type(problem), intent(in) :: model
    type(time_increment), intent(in) :: time !< of the increment
    type(point_state), intent(in) :: old(:), new(:) !< (blocks) at its start and at its end
    type(path_error), intent(inout) :: path
    integer :: i, p
    do i = 1, size(new)
      if (all(new(i)%is_elastic)) cycle
      associate (part => model%inelastic(i))
        if (.not. model%materials(part%material)%law%may_be_tried) cycle
        do p = 1, part%points%num_points
          if (dissipated(new(i), p) <= dissipated(old(i), p)) cycle
          if (mod(path%num_changes, stride) == 0) then
            call repeat_point(model%materials(part%material)%law, part, p, time, old(i), new(i), &
                              path)
          end if
          path%num_changes = path%num_changes + 1
        end do
      end associate
    end do
  end subroutine sample_paths

  !> The energy that a point has dissipated so far [J/m3].
  pure real(rk) function dissipated(state, p)
    type(point_state), intent(in) :: state
    integer, intent(in) :: p
    dissipated = state%energy(fracture_energy, p) + state%energy(crushing_energy, p)
  end function dissipated

  !> One point: the increment in two halves. A half that the law cannot take is no sample.
  subroutine repeat_point(law, part, p, time, old, new, path)
    class(stress_law), intent(in) :: law
    type(inelastic_block), intent(in) :: part
    integer, intent(in) :: p
    type(time_increment), intent(in) :: time
    type(point_state), intent(in) :: old, new
    type(path_error), intent(inout) :: path
    type(time_increment) :: half
    type(point_set) :: place
    type(point_state) :: at(0:2)
    type(update_report) :: report
    real(rk) :: tangent(6, 6, 0), weight
    integer :: k
    half = time
    half%size = 0.5_rk*time%size
    half%tangent = no_tangent
    half%wants_energy = .true.
    call take_place(part%points, p, place)
    call take_point(old, p, at(0))
    do k = 1, 2
      call take_point(new, p, at(k))
      at(k)%strain = at(0)%strain + 0.5_rk*k*(at(k)%strain - at(0)%strain)
      call law%update(place, half, at(k - 1), at(k), tangent, report)
      if (report%failed_point > 0) return
    end do
    weight = part%weight(mod(p - 1, part%points_of_element) + 1, &
                         (p - 1)/part%points_of_element + 1)
    path%num_points = path%num_points + 1
    path%dissipated = path%dissipated + weight*(dissipated(new, p) - dissipated(old, p))
    path%difference = path%difference + weight*abs(dissipated(new, p) - dissipated(at(2), 1))
    path%stress = max(path%stress, maxval(abs(new%stress(:, p) - at(2)%stress(:, 1))))
  end subroutine repeat_point

  !> One point of a set.
  subroutine take_place(points, p, place)
    type(point_set), intent(in) :: points
    integer, intent(in) :: p
    type(point_set), intent(out) :: place
    place%num_points = 1
    place%element = points%element(p:p)
    place%number = points%number(p:p)
    place%x = points%x(:, p:p)
    place%edges = points%edges(:, :, p:p)
    place%widest = points%widest(p:p)
    place%length = points%length(p:p)
  end subroutine take_place

  !> The state of one point.
  subroutine take_point(state, p, own)
    type(point_state), intent(in) :: state
    integer, intent(in) :: p
    type(point_state), intent(out) :: own
    own%strain = state%strain(:, p:p)
    own%stress = state%stress(:, p:p)
    own%internal = state%internal(:, p:p)
    own%energy = state%energy(:, p:p)
    own%is_elastic = state%is_elastic(p:p)
    if (size(state%gradient, 3) > 0) own%gradient = state%gradient(:, :, p:p)
    if (allocated(state%temperature)) own%temperature = state%temperature(p:p)
    if (allocated(state%thermal)) own%thermal = state%thermal(:, p:p)
  end subroutine take_point
end module path_sampling
