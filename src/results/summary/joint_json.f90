!> Joints, interfaces of different meshes, and extremes by face in job.json.
module joint_json
  use extremes, only: extremes_by_face, face_names
  use joint_points, only: dam_joint
  use joint_readings, only: gap_in_mesh
  use json_writer, only: json_text, lower
  use kinds, only: rk
  use problem_definition, only: problem
  use run_records, only: run_record
  implicit none
  private
  public :: put_joints, put_interfaces, put_extremes

  !> A slave facet has no partner when a larger fraction of its area is uncovered.
  real(rk), parameter :: most_bare = 0.5_rk

  integer, parameter :: most_listed = 1000 !< elements without partner

contains

  !> Composition and extremes of each joint.
  subroutine put_joints(json, model, record)
    type(json_text), intent(inout) :: json
    type(problem), intent(in) :: model
    type(run_record), intent(in) :: record
    integer :: j
    call json%open_object('joints')
    do j = 1, size(model%joints)
      call json%open_object(model%joints(j)%name)
      call put_composition(json, model%joints(j))
      call put_extremes(json, 'opening', record%joints(j)%opening)
      call put_extremes(json, 'slip', record%joints(j)%slip)
      call put_extremes(json, 'pressure', record%joints(j)%pressure)
      if (any(record%joints(j)%water%at%is_found)) then
        call put_extremes(json, 'water', record%joints(j)%water)
      end if
      call json%close_object()
    end do
    call json%close_object()
  end subroutine put_joints

  !> Composition of a joint.
  subroutine put_composition(json, joint)
    type(json_text), intent(inout) :: json
    type(dam_joint), intent(in) :: joint
    call json%put_text(trim(merge('elements', 'surfaces', joint%is_matching)), 'kind')
    call json%put_text(trim(merge('nodes', 'gauss', joint%is_nodal)), 'integration')
    call json%put_integer(joint%num_points, 'points')
    if (allocated(joint%parts)) then ! of the complete joint, not that of the last step
      call json%put_real(sum(joint%parts%area), 'area')
    else
      call json%put_real(sum(joint%area), 'area')
    end if
    if (gap_in_mesh(joint) > 0.0_rk) call json%put_real(gap_in_mesh(joint), 'open_in_mesh')
  end subroutine put_composition

  !> Extremes anywhere, upstream and downstream, where they exist.
  subroutine put_extremes(json, name, found)
    type(json_text), intent(inout) :: json
    character(*), intent(in) :: name
    type(extremes_by_face), intent(in) :: found
    integer :: i
    call json%open_object(name)
    do i = 1, size(found%at)
      if (.not. found%at(i)%is_found) cycle
      call json%open_object(trim(face_names(i)))
      call json%put_real(found%at(i)%value, 'value')
      call json%put_real(found%at(i)%time, 'time')
      call json%put_reals(found%at(i)%x, 'x')
      call json%close_object()
    end do
    call json%close_object()
  end subroutine put_extremes

  !> Overlap of interfaces of different meshes.
  subroutine put_interfaces(json, model)
    type(json_text), intent(inout) :: json
    type(problem), intent(in) :: model
    integer :: i
    call json%open_array('interfaces')
    if (allocated(model%covers)) then
      do i = 1, size(model%covers)
        associate (cover => model%covers(i)%cover)
          call json%open_object()
          call json%put_text(model%covers(i)%name, 'name')
          call json%put_text(lower(model%covers(i)%kind), 'kind')
          call json%put_real(cover%slave_area, 'slave_area')
          call json%put_real(cover%master_area, 'master_area')
          call json%put_real(cover%covered_area, 'covered_area')
          call json%put_integer(count(cover%bare > most_bare), 'facets_without_partner')
          call put_elements(json, model, pack(cover%element, cover%bare > most_bare))
          call json%put_real(cover%largest_gap, 'largest_gap')
          call json%put_reals(cover%gap_place, 'gap_at')
          call json%put_real(cover%largest_overlap, 'largest_overlap')
          call json%put_reals(cover%overlap_place, 'overlap_at')
          call json%close_object()
        end associate
      end do
    end if
    call json%close_array()
  end subroutine put_interfaces

  !> Numbers of elements, at most `most_listed`.
  subroutine put_elements(json, model, elements)
    type(json_text), intent(inout) :: json
    type(problem), intent(in) :: model
    integer, intent(in) :: elements(:) !< positions
    integer :: i
    call json%open_array('elements_without_partner')
    do i = 1, min(size(elements), most_listed)
      call json%put_integer(model%mesh%element_id(elements(i)))
    end do
    call json%close_array()
  end subroutine put_elements
end module joint_json
