!> Largest (or smallest) value so far, with time and place: anywhere and on each face of the dam.
module extremes
  use kinds, only: rk
  implicit none
  private
  public :: extreme, extremes_by_face, face_names, forget_faces, note_histories, note_values
  public :: may_exceed

  !> The order of `extremes_by_face%at`.
  character(10), parameter :: face_names(3) = ['anywhere  ', 'upstream  ', 'downstream']

  !> The extreme of one quantity in one region.
  type :: extreme
    logical :: is_found = .false.
    real(rk) :: value = 0.0_rk
    real(rk) :: time = 0.0_rk !< total time [s]
    real(rk) :: x(3) = 0.0_rk !< [m]
  end type extreme

  !> The extremes of one quantity.
  type :: extremes_by_face
    type(extreme) :: at(3) !< anywhere, upstream, downstream
  end type extremes_by_face

contains

  !> Whether values can be beyond an extreme anywhere or on a face; false for most increments.
  pure logical function may_exceed(record, values, wants_smallest)
    type(extremes_by_face), intent(in) :: record
    real(rk), intent(in) :: values(:)
    logical, intent(in) :: wants_smallest
    may_exceed = .true.
    if (.not. all(record%at%is_found)) return
    if (wants_smallest) then
      may_exceed = any(values < maxval(record%at%value))
    else
      may_exceed = any(values > minval(record%at%value))
    end if
  end function may_exceed

  !> Includes the values at one time. Equal values keep the earlier time and place.
  subroutine note_values(record, values, x, is_upstream, is_downstream, time, wants_smallest)
    type(extremes_by_face), intent(inout) :: record
    real(rk), intent(in) :: values(:)
    real(rk), intent(in) :: x(:, :) !< (3, size of `values`) [m]
    logical, intent(in) :: is_upstream(:), is_downstream(:)
    real(rk), intent(in) :: time !< [s]
    logical, intent(in) :: wants_smallest
    real(rk) :: sign_of
    integer :: i
    sign_of = merge(-1.0_rk, 1.0_rk, wants_smallest)
    do i = 1, size(values)
      call note_value(record%at(1), values(i), sign_of)
      if (is_upstream(i)) call note_value(record%at(2), values(i), sign_of)
      if (is_downstream(i)) call note_value(record%at(3), values(i), sign_of)
    end do

  contains

    !> Replaces the extreme by value `i` when `sign_of` times the value is larger.
    subroutine note_value(kept, value, sign_of)
      type(extreme), intent(inout) :: kept
      real(rk), intent(in) :: value, sign_of
      if (kept%is_found .and. sign_of*(value - kept%value) <= 0.0_rk) return
      kept = extreme(.true., value, time, x(:, i))
    end subroutine note_value
  end subroutine note_values

  !> Forgets the extremes on both faces.
  pure subroutine forget_faces(record)
    type(extremes_by_face), intent(inout) :: record
    record%at(2:) = extreme()
  end subroutine forget_faces

  !> Finds the extremes on both faces from the extreme of each place and its time: those that
  !> `note_values` finds from all times.
  pure subroutine note_histories(record, values, times, x, is_upstream, is_downstream, &
                                 wants_smallest)
    type(extremes_by_face), intent(inout) :: record
    real(rk), intent(in) :: values(:), times(:) !< (places) times in s
    real(rk), intent(in) :: x(:, :) !< (3, places) [m]
    logical, intent(in) :: is_upstream(:), is_downstream(:) !< (places)
    logical, intent(in) :: wants_smallest
    real(rk) :: sign_of
    sign_of = merge(-1.0_rk, 1.0_rk, wants_smallest)
    record%at(2) = largest_of(is_upstream)
    record%at(3) = largest_of(is_downstream)

  contains

    !> The largest of the marked places, of these the earliest, of these the first.
    pure type(extreme) function largest_of(is_marked) result(found)
      logical, intent(in) :: is_marked(:)
      logical :: is_largest(size(values))
      integer :: i
      if (.not. any(is_marked)) return
      is_largest = is_marked .and. sign_of*values >= maxval(sign_of*values, mask=is_marked)
      i = minloc(times, dim=1, mask=is_largest)
      if (i > 0) found = extreme(.true., values(i), times(i), x(:, i))
    end function largest_of
  end subroutine note_histories
end module extremes
