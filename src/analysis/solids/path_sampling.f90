!> Follows sampled points over each increment in two halves, beside the run: what the law leaves
!> open within increments (theory.md, 14.7).
module path_sampling
  use kinds, only: rk
  use inelastic_blocks, only: inelastic_block
  use material_law, only: stress_law
  use material_points, only: crushing_energy, fracture_energy, make_room, no_tangent, point_set, &
                             point_state, time_increment, update_report
  use path_errors, only: path_error
  use path_twins, only: gather_points, twin_points
  use problem_definition, only: problem
  implicit none
  private
  public :: sample_paths

  !> One of so many points that begin to dissipate gets a twin, in models of few points and in
  !> others. A twin takes two updates an increment; the iteration updates each point several times.
  integer, parameter :: short_stride = 7, stride = 47 ! prime: all points of elements have a turn
  integer, parameter :: few_points = 500

contains

  !> Takes the twins over an increment that was accepted.
  subroutine sample_paths(model, time, old, new, twins, path)
    type(problem), intent(in) :: model
    type(time_increment), intent(in) :: time !< of the increment
    type(point_state), intent(in) :: old(:), new(:) !< (blocks) at its start and at its end
    type(twin_points), allocatable, intent(inout) :: twins(:) !< (materials)
    type(path_error), intent(inout) :: path
    integer :: m, own_stride
    real(rk) :: before
    if (.not. allocated(twins)) allocate (twins(size(model%materials)))
    path%num_points = 0
    path%dissipated = 0.0_rk
    before = path%difference
    own_stride = merge(short_stride, stride, num_points_of(model%inelastic) < few_points)
    path%difference = 0.0_rk
    do m = 1, size(twins)
      if (.not. allocated(model%materials(m)%law)) cycle
      if (.not. model%materials(m)%law%may_be_tried) cycle
      call forget_twins_at_rest(old, twins(m))
      call add_twins(model, m, own_stride, old, new, twins(m), path%num_found)
      if (twins(m)%num_twins() == 0) cycle
      call follow(model%materials(m)%law, model%inelastic, time, old, new, twins(m))
      call compare(model%inelastic, new, twins(m), path)
    end do
    path%difference = max(path%difference, before) ! errors of two signs cancel later on
  end subroutine sample_paths

  !> A point without history has no path: its element was built anew.
  subroutine forget_twins_at_rest(old, twins)
    type(point_state), intent(in) :: old(:)
    type(twin_points), intent(inout) :: twins
    integer :: i
    call twins%keep([(dissipated(old(twins%block(i)), twins%point(i)) > 0.0_rk .or. &
                      dissipated(twins%at, i) <= 0.0_rk, i=1, twins%num_twins())])
  end subroutine forget_twins_at_rest

  !> Adds twins of points of one material that begin to dissipate.
  subroutine add_twins(model, material, own_stride, old, new, twins, num_found)
    type(problem), intent(in) :: model
    integer, intent(in) :: material
    integer, intent(in) :: own_stride !< of points that begin to dissipate
    type(point_state), intent(in) :: old(:), new(:)
    type(twin_points), intent(inout) :: twins
    integer, intent(inout) :: num_found !< points that have begun
    integer, allocatable :: block(:), point(:)
    integer :: i, p
    allocate (block(0), point(0))
    do i = 1, size(new)
      if (model%inelastic(i)%material /= material .or. all(new(i)%is_elastic)) cycle
      do p = 1, model%inelastic(i)%points%num_points
        if (dissipated(new(i), p) <= 0.0_rk .or. dissipated(old(i), p) > 0.0_rk) cycle
        if (mod(num_found, own_stride) == 0) then
          block = [block, i]
          point = [point, p]
        end if
        num_found = num_found + 1
      end do
    end do
    call twins%add(old, block, point)
  end subroutine add_twins

  !> Number of points of all blocks.
  pure integer function num_points_of(parts)
    type(inelastic_block), intent(in) :: parts(:)
    integer :: i
    num_points_of = 0
    do i = 1, size(parts)
      num_points_of = num_points_of + parts(i)%points%num_points
    end do
  end function num_points_of

  !> The energy that a point has dissipated so far [J/m3].
  pure real(rk) function dissipated(state, p)
    type(point_state), intent(in) :: state
    integer, intent(in) :: p
    dissipated = state%energy(fracture_energy, p) + state%energy(crushing_energy, p)
  end function dissipated

  !> Takes the twins of one material over the increment in two halves. A twin that the law cannot
  !> take is forgotten.
  subroutine follow(law, parts, time, old, new, twins)
    class(stress_law), intent(in) :: law
    type(inelastic_block), intent(in) :: parts(:)
    type(time_increment), intent(in) :: time
    type(point_state), intent(in) :: old(:), new(:)
    type(twin_points), intent(inout) :: twins
    type(point_state) :: at(0:2), start
    type(point_set) :: place
    integer :: failed, i
    do while (twins%num_twins() > 0)
      call gather_places(parts, twins, place)
      call gather_points(old, twins%block, twins%point, start)
      call gather_points(new, twins%block, twins%point, at(2))
      at(0) = twins%at
      at(0)%strain = start%strain
      at(1) = at(2)
      at(1)%strain = 0.5_rk*(start%strain + at(2)%strain)
      call take_halves(law, place, time, at, failed)
      if (failed == 0) then
        twins%at = at(2)
        return
      end if
      call twins%keep([(i /= failed, i=1, twins%num_twins())])
    end do
  end subroutine follow

  !> Updates points twice.
  subroutine take_halves(law, place, time, at, failed)
    class(stress_law), intent(in) :: law
    type(point_set), intent(in) :: place
    type(time_increment), intent(in) :: time !< of the whole increment
    type(point_state), intent(inout) :: at(0:) !< its start, middle and end
    integer, intent(out) :: failed !< point that the law cannot take; 0: none
    type(time_increment) :: half
    type(update_report) :: report
    real(rk) :: tangent(6, 6, 0)
    integer :: k
    half = time
    half%size = 0.5_rk*time%size
    half%tangent = no_tangent
    half%wants_energy = .true.
    do k = 1, 2
      call law%update(place, half, at(k - 1), at(k), tangent, report)
      failed = report%failed_point
      if (failed > 0) return
    end do
  end subroutine take_halves

  !> Adds what the twins of one material differ by from their points.
  subroutine compare(parts, new, twins, path)
    type(inelastic_block), intent(in) :: parts(:)
    type(point_state), intent(in) :: new(:)
    type(twin_points), intent(in) :: twins
    type(path_error), intent(inout) :: path
    real(rk) :: own, weight
    integer :: i
    do i = 1, twins%num_twins()
      associate (part => parts(twins%block(i)), state => new(twins%block(i)), p => twins%point(i))
        weight = part%weight(mod(p - 1, part%points_of_element) + 1, &
                             (p - 1)/part%points_of_element + 1)
        own = dissipated(state, p)
        path%dissipated = path%dissipated + weight*own
        path%difference = path%difference + weight*abs(own - dissipated(twins%at, i))
        path%stress = max(path%stress, maxval(abs(state%stress(:, p) - twins%at%stress(:, i))))
      end associate
    end do
    path%num_points = path%num_points + twins%num_twins()
  end subroutine compare

  !> The places of the twins.
  subroutine gather_places(parts, twins, place)
    type(inelastic_block), intent(in) :: parts(:)
    type(twin_points), intent(in) :: twins
    type(point_set), intent(out) :: place
    integer :: i, n
    n = twins%num_twins()
    call make_room(place, n)
    do i = 1, n
      associate (from => parts(twins%block(i))%points, p => twins%point(i))
        place%element(i) = from%element(p)
        place%number(i) = from%number(p)
        place%x(:, i) = from%x(:, p)
        place%edges(:, :, i) = from%edges(:, :, p)
        place%widest(i) = from%widest(p)
        place%length(i) = from%length(p)
      end associate
    end do
  end subroutine gather_places
end module path_sampling
