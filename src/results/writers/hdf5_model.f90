!> The model in job.h5: mesh, sets, surfaces, joints. Written once, at the start.
module hdf5_model
  use dam_mesh, only: named_set
  use problem_definition, only: problem
  use joint_points, only: joint, joint_cells
  use run_records, only: run_record
  use joint_readings, only: joint_record
  use hdf5_files, only: hdf5_file
  use file_system, only: link_name
  implicit none
  private
  public :: write_model

contains

  !> Everything that does not change in time.
  subroutine write_model(file, scene, record)
    type(hdf5_file), intent(inout) :: file
    type(problem), intent(in) :: scene
    type(run_record), intent(in) :: record
    integer :: j
    call write_mesh(file, scene)
    call file%make_group('/sets')
    call write_sets(file, '/sets/nodes', scene%node_sets, scene%mesh%node_id)
    call write_sets(file, '/sets/elements', scene%element_sets, scene%mesh%element_id)
    call write_surfaces(file, scene)
    call file%make_group('/faces')
    call file%put('/faces/upstream', merge(1, 0, record%skin%is_upstream))
    call file%put('/faces/downstream', merge(1, 0, record%skin%is_downstream))
    call file%make_group('/joints')
    do j = 1, size(scene%joints)
      call write_joint(file, scene, scene%joints(j), record%joints(j))
    end do
  end subroutine write_model

  !> Nodes, elements and materials.
  subroutine write_mesh(file, scene)
    type(hdf5_file), intent(inout) :: file
    type(problem), intent(in) :: scene
    character(80) :: names(size(scene%materials))
    integer :: m
    do m = 1, size(scene%materials)
      names(m) = scene%materials(m)%name
    end do
    call file%make_group('/mesh')
    call file%put('/mesh/node_id', scene%mesh%node_id)
    call file%put('/mesh/x', scene%mesh%x)
    call file%put('/mesh/element_id', scene%mesh%element_id)
    call file%put_texts('/mesh/element_type', scene%mesh%element_type)
    call file%put('/mesh/connectivity', scene%mesh%nodes - 1)
    call file%put('/mesh/material', scene%mesh%material_of_element - 1)
    call file%put('/mesh/section', scene%mesh%section_of_element - 1)
    call file%put_texts('/mesh/material_names', names)
  end subroutine write_mesh

  !> Sets of nodes or elements, by the numbers of the deck.
  subroutine write_sets(file, group, sets, id)
    type(hdf5_file), intent(inout) :: file
    character(*), intent(in) :: group
    type(named_set), intent(in) :: sets(:)
    integer, intent(in) :: id(:)
    integer :: i
    call file%make_group(group)
    do i = 1, size(sets)
      call file%put(group//'/'//link_name(sets(i)%name), id(sets(i)%members))
    end do
  end subroutine write_sets

  !> Surfaces: element and face S1..S6.
  subroutine write_surfaces(file, scene)
    type(hdf5_file), intent(inout) :: file
    type(problem), intent(in) :: scene
    integer :: i
    call file%make_group('/sets/surfaces')
    do i = 1, size(scene%surfaces)
      associate (faces => scene%surfaces(i))
        call file%put('/sets/surfaces/'//link_name(faces%name), &
                      transpose(reshape([scene%mesh%element_id(faces%element), faces%face], &
                                        [size(faces%face), 2])))
      end associate
    end do
  end subroutine write_surfaces

  !> The points of a joint.
  subroutine write_joint(file, scene, item, faces)
    type(hdf5_file), intent(inout) :: file
    type(problem), intent(in) :: scene
    type(joint), intent(in) :: item
    type(joint_record), intent(in) :: faces
    character(:), allocatable :: group
    group = '/joints/'//link_name(item%name)
    call file%make_group(group)
    call file%set(group, 'gap', item%law%gap)
    call file%put(group//'/x', item%x)
    call file%put(group//'/area', item%area)
    ! The axes are the rows for a reader whose last index runs fastest.
    call file%put(group//'/rotation', reshape(item%rotation, shape(item%rotation), order=[2, 1, 3]))
    call file%put(group//'/clearance', item%clearance)
    call file%put(group//'/reach', item%admissible_slip)
    call file%put(group//'/first', item%first)
    call file%put(group//'/first_master', item%first_master)
    call file%put(group//'/node', scene%mesh%node_id(item%node))
    call file%put(group//'/weight', item%weight)
    call file%put(group//'/upstream', merge(1, 0, faces%is_upstream))
    call file%put(group//'/downstream', merge(1, 0, faces%is_downstream))
    if (allocated(item%cells%first)) call write_cells(file, scene, item%cells, group//'/cells')
  end subroutine write_joint

  !> The polygons that are drawn of a joint.
  subroutine write_cells(file, scene, cells, group)
    type(hdf5_file), intent(inout) :: file
    type(problem), intent(in) :: scene
    type(joint_cells), intent(in) :: cells
    character(*), intent(in) :: group
    call file%make_group(group)
    call file%put(group//'/first', cells%first)
    call file%put(group//'/corner', cells%corner)
    call file%put(group//'/element', scene%mesh%element_id(cells%element))
    call file%put(group//'/first_node', cells%first_node)
    call file%put(group//'/node', scene%mesh%node_id(cells%node))
    call file%put(group//'/weight', cells%weight)
  end subroutine write_cells
end module hdf5_model
