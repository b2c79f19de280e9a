!> A curved plate like an arch dam, fixed at the bottom, with vertical joints between its blocks.
module arch_model
  use kinds, only: rk
  use problem_definition, only: problem
  use joint_contraction, only: contraction_law
  use material_elastic, only: elastic_law
  use row_model, only: add_gravity, new_step
  use joint_points, only: dam_joint, list_faces
  use step_plan, only: step_fixity
  implicit none
  private
  public :: make_arch, make_heavy_arch

contains

  !> Three blocks with joints of one law, and a static step with their weight.
  subroutine make_heavy_arch(law, model)
    type(contraction_law), intent(in) :: law
    type(problem), intent(out) :: model
    type(step_fixity), allocatable :: fixities(:)
    integer :: i
    call make_arch(1, 2, 3, 3, model, fixities)
    allocate (model%amplitudes(0), model%initial_values(0), model%steps(0))
    do i = 1, size(model%joints)
      model%joints(i)%name = 'J'
      model%joints(i)%kind = 'joint'
      allocate (model%joints(i)%law, source=law)
    end do
    call add_gravity(9.81_rk, model)
    call new_step('STATIC', 1.0_rk, 1.0_rk, model)
    model%steps(1)%fixities = fixities
  end subroutine make_heavy_arch

  !> Blocks of the same size side by side; each pair of neighbours is one joint of node pairs.
  subroutine make_arch(across, along, over, num_blocks, model, fixities)
    integer, intent(in) :: across, along, over !< elements: thickness, arc of one block, height
    integer, intent(in) :: num_blocks
    type(problem), intent(out) :: model
    type(step_fixity), allocatable, intent(out) :: fixities(:)
    integer :: b, k, i
    call make_material(model)
    call make_mesh(across, along, over, num_blocks, model)
    allocate (model%joints(num_blocks - 1), model%loads(0))
    allocate (model%guests(0))
    do b = 1, num_blocks - 1
      call make_joint(across, along, over, b, num_blocks, model, model%joints(b))
    end do
    allocate (fixities(3*count(model%mesh%x(3, :) <= 0.0_rk)))
    k = 0
    do b = 1, model%mesh%num_nodes
      if (model%mesh%x(3, b) > 0.0_rk) cycle
      do i = 1, 3
        k = k + 1
        fixities(k)%node = b
        fixities(k)%dof = i
      end do
    end do
  end subroutine make_arch

  subroutine make_material(model)
    type(problem), intent(inout) :: model
    allocate (model%materials(1))
    model%materials(1)%density = 2400.0_rk
    model%materials(1)%young = 31.0e9_rk
    model%materials(1)%poisson = 0.2_rk
    allocate (model%materials(1)%law, source=elastic_law(young=31.0e9_rk, poisson=0.2_rk))
  end subroutine make_material

  subroutine make_mesh(across, along, over, num_blocks, model)
    integer, intent(in) :: across, along, over, num_blocks
    type(problem), intent(inout) :: model
    integer :: b, i, j, k, e
    associate (m => model%mesh)
      m%num_nodes = num_blocks*(along + 1)*(across + 1)*(over + 1)
      m%num_elements = num_blocks*along*across*over
      allocate (m%x(3, m%num_nodes), m%nodes(8, m%num_elements), m%element_type(m%num_elements))
      allocate (m%material_of_element(m%num_elements), m%section_of_element(m%num_elements))
      m%node_id = [(i, i=1, m%num_nodes)]
      m%element_id = [(i, i=1, m%num_elements)]
      m%element_type = 'C3D8'
      m%material_of_element = 1
      m%section_of_element = 1
    end associate
    e = 0
    do b = 1, num_blocks
      do k = 0, over
        do j = 0, along
          call add_row()
        end do
      end do
    end do
  contains
    !> Nodes, and elements where there is room for them, through the thickness.
    subroutine add_row()
      do i = 0, across
        model%mesh%x(:, node_at(b, i, j, k)) = &
          place(real(i, rk)/across, (b - 1 + real(j, rk)/along)/num_blocks, real(k, rk)/over)
        if (i == across .or. j == along .or. k == over) cycle
        e = e + 1
        model%mesh%nodes(:, e) = [node_at(b, i, j, k), node_at(b, i + 1, j, k), &
                                  node_at(b, i + 1, j + 1, k), node_at(b, i, j + 1, k), &
                                  node_at(b, i, j, k + 1), node_at(b, i + 1, j, k + 1), &
                                  node_at(b, i + 1, j + 1, k + 1), node_at(b, i, j + 1, k + 1)]
      end do
    end subroutine add_row

    pure integer function node_at(block, i, j, k)
      integer, intent(in) :: block, i, j, k
      node_at = 1 + i + (across + 1)*(j + (along + 1)*(k + (over + 1)*(block - 1)))
    end function node_at
  end subroutine make_mesh

  !> A sector of 100 degrees, radius 150 m, 100 m high, thickness from 30 to 8 m.
  pure function place(depth, arc, height) result(x)
    real(rk), intent(in) :: depth, arc, height !< 0..1
    real(rk) :: x(3), radius, angle
    radius = 150.0_rk - (depth - 0.5_rk)*(30.0_rk - 22.0_rk*height)
    angle = (arc - 0.5_rk)*1.745_rk
    x = [radius*sin(angle), radius*cos(angle), 100.0_rk*height]
  end function place

  !> The pairs between block b (master) and the next (slave), above the fixed bottom.
  subroutine make_joint(across, along, over, b, num_blocks, model, joint)
    integer, intent(in) :: across, along, over, b, num_blocks
    type(problem), intent(in) :: model
    type(dam_joint), intent(out) :: joint
    real(rk) :: angle
    integer, allocatable :: master(:, :), slave(:, :)
    integer :: i, k, p, nodes_of_block
    nodes_of_block = (across + 1)*(along + 1)*(over + 1)
    angle = (real(b, rk)/num_blocks - 0.5_rk)*1.745_rk
    p = (across + 1)*over
    allocate (master(1, p), slave(1, p), joint%rotation(3, 3, p), joint%area(p))
    p = 0
    do k = 1, over
      do i = 0, across
        p = p + 1
        master(1, p) = 1 + i + (across + 1)*(along + (along + 1)*k) + (b - 1)*nodes_of_block
        slave(1, p) = 1 + i + (across + 1)*(along + 1)*k + b*nodes_of_block
      end do
    end do
    call list_faces(slave, master, reshape([1.0_rk], shape(slave), pad=[1.0_rk]), joint)
    joint%x = model%mesh%x(:, master(1, :))
    joint%area = 2000.0_rk/joint%num_points
    do p = 1, joint%num_points
      joint%rotation(1, :, p) = [cos(angle), -sin(angle), 0.0_rk]
      joint%rotation(2, :, p) = [sin(angle), cos(angle), 0.0_rk]
      joint%rotation(3, :, p) = [0.0_rk, 0.0_rk, 1.0_rk]
    end do
  end subroutine make_joint
end module arch_model
