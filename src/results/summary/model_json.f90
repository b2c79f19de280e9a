!> The model in job.json: counts, and instances of parts.
module model_json
  use instance_list, only: mesh_instance
  use json_writer, only: json_text
  use problem_definition, only: problem
  implicit none
  private
  public :: put_instances, put_model

contains

  !> Counts.
  subroutine put_model(json, model, num_unknowns)
    type(json_text), intent(inout) :: json
    type(problem), intent(in) :: model
    integer, intent(in) :: num_unknowns
    call json%open_object('model')
    call json%put_integer(model%mesh%num_nodes, 'nodes')
    call json%put_integer(model%mesh%num_elements, 'elements')
    call json%put_integer(num_unknowns, 'unknowns')
    call json%put_integer(size(model%joints), 'joints')
    call json%put_integer(size(model%materials), 'materials')
    call json%close_object()
  end subroutine put_model

  !> The instances of parts and, last and without a name, what stands outside them, with what is
  !> added to the numbers of their nodes and elements.
  subroutine put_instances(json, model)
    type(json_text), intent(inout) :: json
    type(problem), intent(in) :: model
    integer :: i
    if (.not. allocated(model%instances)) return
    if (size(model%instances) == 0) return
    call json%open_array('instances')
    do i = 1, size(model%instances)
      call put_instance(json, model%instances(i))
    end do
    if (model%outside%has_members) call put_instance(json, model%outside)
    call json%close_array()
  end subroutine put_instances

  subroutine put_instance(json, one)
    type(json_text), intent(inout) :: json
    type(mesh_instance), intent(in) :: one
    call json%open_object()
    call json%put_text(one%name, 'name')
    call json%put_text(one%part, 'part')
    call json%put_integer(one%nodes_added, 'nodes_added')
    call json%put_integer(one%elements_added, 'elements_added')
    call json%close_object()
  end subroutine put_instance
end module model_json
