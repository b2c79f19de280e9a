!> *ENVELOPE: maxima over a step at every node, and their extremes over all steps.
module envelopes
  use kinds, only: rk
  use extremes, only: extremes_by_face
  use step_plan, only: field_name_length
  implicit none
  private
  public :: envelope, open_envelope, note_envelope, note_means, name_of_field

  !> Envelope of one field; of the length for a vector.
  type :: envelope
    character(field_name_length) :: name = ''
    integer :: row = 0 !< of the table of fields
    logical :: wants_smallest = .false.
    logical :: is_empty = .true. !< no values in this step yet
    real(rk), allocatable :: value(:), time(:) !< (nodes), of this step
    real(rk), allocatable :: mean(:) !< (elements) largest element means, of fields with means
    type(extremes_by_face) :: largest !< of all steps with this envelope
    real(rk) :: error = -1.0_rk !< of the mesh in the extreme anywhere; < 0: place_errors
    real(rk) :: found_at = 0.0_rk !< extreme of this step whose error was found, not scaled
    integer :: cause = 0 !< that makes the place of this extreme singular: singular_places
  end type envelope

contains

  !> Starts a step; the extremes of earlier steps are kept.
  subroutine open_envelope(item, name, row, wants_smallest, num_nodes)
    type(envelope), intent(inout) :: item
    character(*), intent(in) :: name
    integer, intent(in) :: row !< of the table of fields
    logical, intent(in) :: wants_smallest
    integer, intent(in) :: num_nodes
    item%name = name
    item%row = row
    item%wants_smallest = wants_smallest
    item%is_empty = .true.
    item%found_at = 0.0_rk
    if (.not. allocated(item%value)) allocate (item%value(num_nodes), item%time(num_nodes))
    item%value = 0.0_rk
    item%time = 0.0_rk
    if (allocated(item%mean)) item%mean = 0.0_rk
  end subroutine open_envelope

  !> Includes the values on the nodes at one time.
  subroutine note_envelope(item, values, time)
    type(envelope), intent(inout) :: item
    real(rk), intent(in) :: values(:) !< (nodes)
    real(rk), intent(in) :: time !< total time [s]
    if (item%is_empty) then
      item%value = values
      item%time = time
    else if (item%wants_smallest) then
      where (values < item%value) item%time = time
      item%value = min(values, item%value)
    else
      where (values > item%value) item%time = time
      item%value = max(values, item%value)
    end if
    item%is_empty = .false.
  end subroutine note_envelope

  !> Includes the element means of a quantity that is never negative.
  subroutine note_means(item, values)
    type(envelope), intent(inout) :: item
    real(rk), intent(in) :: values(:) !< (elements)
    if (.not. allocated(item%mean)) allocate (item%mean(size(values)), source=0.0_rk)
    item%mean = max(values, item%mean)
  end subroutine note_means

  !> The name of the field in files: 'S1_MAX', 'S3_MIN', ...
  pure function name_of_field(item) result(name)
    type(envelope), intent(in) :: item
    character(:), allocatable :: name
    name = trim(item%name)//'_MAX'
    if (item%wants_smallest) name = trim(item%name)//'_MIN'
  end function name_of_field
end module envelopes
