!> The faces of the dam in a checkpoint. Steps after a checkpoint may bring another reservoir, and
!> so other faces: what the record has found on the old faces is then not what it finds on the new.
module checkpoint_faces
  use analysis_state, only: state
  use archive_type, only: archive
  use dam_faces, only: dam_skin
  use envelopes, only: envelope
  use extremes, only: forget_faces, note_histories
  use field_type, only: at_nodes
  use problem_definition, only: problem
  use run_records, only: run_record
  use write_text, only: as_text
  implicit none
  private
  public :: save_faces, renew_faces

contains

  !> Writes the nodes of both faces.
  subroutine save_faces(skin, file)
    type(dam_skin), intent(in) :: skin
    class(archive), intent(inout) :: file !< open for writing
    logical, allocatable :: is_upstream(:), is_downstream(:)
    is_upstream = skin%is_upstream
    is_downstream = skin%is_downstream
    call file%open_group('faces')
    call file%put('is_upstream', is_upstream)
    call file%put('is_downstream', is_downstream)
    call file%close_group()
  end subroutine save_faces

  !> Where the faces are not those of the checkpoint, the extremes on them are found anew: those of
  !> envelopes on nodes from the nodes, others from now on, with a warning.
  subroutine renew_faces(model, now, file, record)
    type(problem), intent(in) :: model
    type(state), intent(in) :: now !< of the checkpoint
    class(archive), intent(inout) :: file !< open for reading
    type(run_record), intent(inout) :: record !< of the checkpoint, with the faces of the model
    logical, allocatable :: is_upstream(:), is_downstream(:)
    character(:), allocatable :: names
    integer :: n(1), j, i
    n = model%mesh%num_nodes
    call file%open_group('faces')
    call file%get('is_upstream', is_upstream, n)
    call file%get('is_downstream', is_downstream, n)
    call file%close_group()
    if (file%has_failed()) return
    if (all(is_upstream .eqv. record%skin%is_upstream) .and. &
        all(is_downstream .eqv. record%skin%is_downstream)) return
    names = 'displacement'
    call forget_faces(record%displacement)
    if (size(record%joints) > 0) names = names//', joints'
    do j = 1, size(record%joints)
      call forget_faces(record%joints(j)%opening)
      call forget_faces(record%joints(j)%slip)
      call forget_faces(record%joints(j)%pressure)
      call forget_faces(record%joints(j)%water)
    end do
    do i = 1, size(record%envelopes)
      call forget_faces(record%envelopes(i)%largest)
      if (has_all_values(model, record, record%envelopes(i))) then
        call note_nodes(model, record, record%envelopes(i))
      else
        names = names//', envelope of '//trim(record%envelopes(i)%name)
      end if
    end do
    if (.not. record%skin%is_known) return
    call record%warn_once('the upstream and downstream faces of the dam are not those of the '// &
                          'checkpoint: the extremes on these faces count from time '// &
                          as_text(now%total_time)//' on ('//names//'); those anywhere count '// &
                          'from the start')
  end subroutine renew_faces

  !> Whether the values on nodes of an envelope are those of all its steps: it has one step. The
  !> nodes of absent elements have none; extremes of joints and points are not those of nodes.
  logical function has_all_values(model, record, item)
    type(problem), intent(in) :: model
    type(run_record), intent(in) :: record
    type(envelope), intent(in) :: item
    integer :: s, num_steps
    num_steps = 0
    do s = 1, record%step
      if (.not. allocated(model%steps(s)%envelope)) cycle
      if (any(model%steps(s)%envelope == item%name)) num_steps = num_steps + 1
    end do
    has_all_values = num_steps == 1 .and. record%fields(item%row)%place == at_nodes &
                     .and. .not. (item%is_empty .or. allocated(model%stages%is_absent))
  end function has_all_values

  !> Finds the extremes of an envelope on the faces from its nodes, as `run_records` does it.
  subroutine note_nodes(model, record, item)
    type(problem), intent(in) :: model
    type(run_record), intent(inout) :: record
    type(envelope), intent(inout) :: item
    integer, allocatable :: nodes(:)
    call record%list_solid_nodes(model, nodes)
    call note_histories(item%largest, item%value(nodes), item%time(nodes), &
                        model%mesh%x(:, nodes), record%skin%is_upstream(nodes), &
                        record%skin%is_downstream(nodes), item%wants_smallest)
  end subroutine note_nodes
end module checkpoint_faces
