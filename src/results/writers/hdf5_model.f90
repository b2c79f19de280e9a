!> The model in job.h5: mesh, sets, surfaces, joints. Written at the start. Where a run goes on, the
!> deck may have new sets and surfaces, and its later steps another reservoir or weight.
module hdf5_model
  use dam_mesh, only: named_set
  use problem_definition, only: problem
  use joint_points, only: dam_joint, joint_cells
  use run_records, only: run_record
  use joint_readings, only: joint_record
  use hdf5_files, only: hdf5_file
  use hdf5_renewal, only: has_link, renew_integer, renew_integers
  use file_system, only: link_name
  use upward_axis, only: find_upward_axis
  implicit none
  private
  public :: write_model, renew_model

contains

  !> Writes all data that do not change in time.
  subroutine write_model(file, model, record)
    type(hdf5_file), intent(inout) :: file
    type(problem), intent(in) :: model
    type(run_record), intent(in) :: record
    integer :: j
    call write_mesh(file, model)
    call file%make_group('/sets')
    call file%make_group('/sets/nodes')
    call file%make_group('/sets/elements')
    call file%make_group('/sets/surfaces')
    call add_all_sets(file, model)
    call file%make_group('/faces')
    call file%put('/faces/dam', merge(1, 0, record%skin%is_dam))
    call file%put('/faces/upstream', merge(1, 0, record%skin%is_upstream))
    call file%put('/faces/downstream', merge(1, 0, record%skin%is_downstream))
    call file%make_group('/joints')
    do j = 1, size(model%joints)
      call write_joint(file, model, model%joints(j), record%joints(j))
    end do
  end subroutine write_model

  !> Writes what differs from the model in the file, where a run goes on: the upward axis, the faces
  !> of the dam, and sets and surfaces of new names. A checkpoint fixes all others.
  subroutine renew_model(file, model, record)
    type(hdf5_file), intent(inout) :: file
    type(problem), intent(in) :: model
    type(run_record), intent(in) :: record
    integer :: j
    call renew_integer(file, '/mesh', 'up', find_upward_axis(model%loads))
    call add_all_sets(file, model)
    call renew_integers(file, '/faces/dam', merge(1, 0, record%skin%is_dam))
    call renew_integers(file, '/faces/upstream', merge(1, 0, record%skin%is_upstream))
    call renew_integers(file, '/faces/downstream', merge(1, 0, record%skin%is_downstream))
    do j = 1, size(model%joints)
      associate (group => '/joints/'//link_name(model%joints(j)%name), faces => record%joints(j))
        call renew_integers(file, group//'/upstream', merge(1, 0, faces%is_upstream))
        call renew_integers(file, group//'/downstream', merge(1, 0, faces%is_downstream))
      end associate
    end do
  end subroutine renew_model

  !> Writes the sets and surfaces that are not in the file; their groups must exist.
  subroutine add_all_sets(file, model)
    type(hdf5_file), intent(inout) :: file
    type(problem), intent(in) :: model
    call add_sets(file, '/sets/nodes/', model%node_sets, model%mesh%node_id)
    call add_sets(file, '/sets/elements/', model%element_sets, model%mesh%element_id)
    call add_surfaces(file, model)
  end subroutine add_all_sets

  !> Nodes, elements and materials.
  subroutine write_mesh(file, model)
    type(hdf5_file), intent(inout) :: file
    type(problem), intent(in) :: model
    character(:), allocatable :: names(:)
    integer :: longest, m
    longest = 1
    do m = 1, size(model%materials)
      longest = max(longest, len(model%materials(m)%name))
    end do
    allocate (character(longest) :: names(size(model%materials)))
    do m = 1, size(model%materials)
      names(m) = model%materials(m)%name
    end do
    call file%make_group('/mesh')
    call file%set('/mesh', 'up', find_upward_axis(model%loads))
    call file%put('/mesh/node_id', model%mesh%node_id)
    call file%put('/mesh/x', model%mesh%x)
    call file%put('/mesh/element_id', model%mesh%element_id)
    call file%put_texts('/mesh/element_type', model%mesh%element_type)
    call file%put('/mesh/connectivity', model%mesh%nodes - 1)
    call file%put('/mesh/material', model%mesh%material_of_element - 1)
    call file%put('/mesh/section', model%mesh%section_of_element - 1)
    call file%put_texts('/mesh/material_names', names)
  end subroutine write_mesh

  !> Sets of nodes or elements, with the numbers of the deck.
  subroutine add_sets(file, group, sets, id)
    type(hdf5_file), intent(inout) :: file
    character(*), intent(in) :: group !< with '/' at its end
    type(named_set), intent(in) :: sets(:)
    integer, intent(in) :: id(:)
    integer :: i
    do i = 1, size(sets)
      if (has_link(file, group//link_name(sets(i)%name))) cycle
      call file%put(group//link_name(sets(i)%name), id(sets(i)%members))
    end do
  end subroutine add_sets

  !> Surfaces: element and face S1..S6.
  subroutine add_surfaces(file, model)
    type(hdf5_file), intent(inout) :: file
    type(problem), intent(in) :: model
    integer :: i
    do i = 1, size(model%surfaces)
      associate (faces => model%surfaces(i))
        if (has_link(file, '/sets/surfaces/'//link_name(faces%name))) cycle
        call file%put('/sets/surfaces/'//link_name(faces%name), &
                      transpose(reshape([model%mesh%element_id(faces%element), faces%face], &
                                        [size(faces%face), 2])))
      end associate
    end do
  end subroutine add_surfaces

  !> The points of a joint.
  subroutine write_joint(file, model, joint, faces)
    type(hdf5_file), intent(inout) :: file
    type(problem), intent(in) :: model
    type(dam_joint), intent(in) :: joint
    type(joint_record), intent(in) :: faces
    character(:), allocatable :: group
    group = '/joints/'//link_name(joint%name)
    call file%make_group(group)
    call file%set(group, 'gap', joint%law%gap)
    call file%put(group//'/x', joint%x)
    call file%put(group//'/area', joint%area)
    ! Axes are rows for readers in C order.
    call file%put(group//'/rotation', &
                  reshape(joint%rotation, shape(joint%rotation), order=[2, 1, 3]))
    call file%put(group//'/clearance', joint%clearance)
    call file%put(group//'/reach', joint%admissible_slip)
    call file%put(group//'/first', joint%first)
    call file%put(group//'/first_master', joint%first_master)
    call file%put(group//'/node', model%mesh%node_id(joint%node))
    call file%put(group//'/weight', joint%weight)
    call file%put(group//'/upstream', merge(1, 0, faces%is_upstream))
    call file%put(group//'/downstream', merge(1, 0, faces%is_downstream))
    if (allocated(joint%cells%first)) call write_cells(file, model, joint%cells, group//'/cells')
  end subroutine write_joint

  !> The polygons for drawing a joint.
  subroutine write_cells(file, model, cells, group)
    type(hdf5_file), intent(inout) :: file
    type(problem), intent(in) :: model
    type(joint_cells), intent(in) :: cells
    character(*), intent(in) :: group
    call file%make_group(group)
    call file%put(group//'/first', cells%first)
    call file%put(group//'/corner', cells%corner)
    call file%put(group//'/element', model%mesh%element_id(cells%element))
    call file%put(group//'/first_node', cells%first_node)
    call file%put(group//'/node', model%mesh%node_id(cells%node))
    call file%put(group//'/weight', cells%weight)
  end subroutine write_cells
end module hdf5_model
