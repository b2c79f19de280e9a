!> How much disk the results of a run will take, from the requests of the deck.
module run_file_sizes
  use field_table, only: find_field, list_fields
  use field_type, only: result_field
  use kinds, only: rk
  use print_kinds, only: prints_of_elements, prints_of_joints
  use problem_definition, only: problem
  use step_plan, only: field_request, print_request, step
  implicit none
  private
  public :: num_planned, size_of_files

  ! Bytes; the parts that no request changes were measured.
  real(rk), parameter :: of_number = 8.0_rk, of_column = 22.0_rk !< in binary files, in tables
  real(rk), parameter :: of_run = 80.0e3_rk, of_increment = 600.0_rk !< energies, log, joints
  real(rk), parameter :: of_node = 24.0_rk, of_element = 57.0_rk !< the mesh, in each VTK file
  real(rk), parameter :: of_point = 215.0_rk !< a point of *JOINT PRINT
  real(rk), parameter :: start_of_row = 35.0_rk, points_of_solid = 8.0_rk
  real(rk), parameter :: bytes_per_megabyte = 1.0e6_rk

contains

  !> All files of a run without checkpoints [MB].
  real(rk) function size_of_files(model, joint_points) result(megabytes)
    type(problem), intent(in) :: model
    real(rk), intent(in) :: joint_points !< of all joints
    type(result_field), allocatable :: table(:)
    real(rk) :: bytes, mesh
    integer :: i
    call list_fields(table)
    mesh = of_node*model%mesh%num_nodes + of_element*model%mesh%num_elements
    bytes = of_run + mesh
    do i = 1, size(model%steps)
      associate (plan => model%steps(i))
        bytes = bytes + mesh + size_of_step(model, table, plan, mesh, joint_points)
      end associate
    end do
    megabytes = bytes/bytes_per_megabyte
  end function size_of_files

  !> A step: fields, prints, modes, extremes [bytes].
  real(rk) function size_of_step(model, table, plan, mesh, joint_points) result(bytes)
    type(problem), intent(in) :: model
    type(result_field), intent(in) :: table(:)
    type(step), intent(in) :: plan
    real(rk), intent(in) :: mesh !< bytes of the mesh in a VTK file
    real(rk), intent(in) :: joint_points
    real(rk) :: increments
    integer :: i
    bytes = 0.0_rk
    if (plan%procedure%finds_modes) then
      bytes = 6.0_rk*of_number*plan%num_modes*model%mesh%num_nodes
      return
    end if
    increments = num_planned(plan)
    bytes = of_increment*increments
    if (allocated(plan%outputs)) then
      bytes = bytes + num_states(plan%outputs, increments)*mesh
      do i = 1, size(plan%outputs)
        bytes = bytes + num_states(plan%outputs(i:i), increments)*2.0_rk*of_number &
                *model%mesh%num_nodes*num_components(model, table, plan%outputs(i)%fields)
      end do
    end if
    if (.not. allocated(plan%prints)) return
    do i = 1, size(plan%prints)
      bytes = bytes + increments/max(1, plan%prints(i)%frequency) &
              *size_of_print(model, table, plan%prints(i), joint_points)
    end do
  end function size_of_step

  !> Increments that the deck plans; the analysis may cut some, or lengthen them up to the largest.
  pure real(rk) function num_planned(plan)
    type(step), intent(in) :: plan
    real(rk) :: usual
    usual = plan%first_increment
    if (.not. (plan%is_direct .or. plan%follows_accuracy())) then
      if (plan%largest_increment < plan%duration) usual = plan%largest_increment
    end if
    num_planned = max(1.0_rk, plan%duration/max(usual, tiny(1.0_rk)))
  end function num_planned

  !> States that the most frequent of some requests writes.
  pure real(rk) function num_states(requests, increments)
    type(field_request), intent(in) :: requests(:)
    real(rk), intent(in) :: increments
    integer :: i
    num_states = 0.0_rk
    do i = 1, size(requests)
      if (requests(i)%frequency <= 0) cycle
      num_states = max(num_states, aint(increments/requests(i)%frequency) + 1.0_rk)
    end do
  end function num_states

  !> Numbers of some fields at a node.
  real(rk) function num_components(model, table, fields)
    type(problem), intent(in) :: model
    type(result_field), intent(in) :: table(:)
    character(*), intent(in) :: fields(:)
    integer :: i, f
    num_components = 0.0_rk
    do i = 1, size(fields)
      f = find_field(table, trim(fields(i)))
      if (f > 0) num_components = num_components + table(f)%width(model)
    end do
  end function num_components

  !> The rows of a print in one increment [bytes].
  real(rk) function size_of_print(model, table, request, joint_points) result(bytes)
    type(problem), intent(in) :: model
    type(result_field), intent(in) :: table(:)
    type(print_request), intent(in) :: request
    real(rk), intent(in) :: joint_points
    real(rk) :: rows
    if (request%kind == prints_of_joints) then
      rows = joint_points/max(1, size(model%joints))
      if (allocated(request%near_nodes)) then
        if (size(request%near_nodes) > 0) rows = min(rows, real(size(request%near_nodes), rk))
      end if
      bytes = rows*of_point
      return
    end if
    rows = real(size(request%members), rk)
    if (request%kind == prints_of_elements) rows = points_of_solid*rows
    bytes = rows*(start_of_row + of_column*num_components(model, table, request%fields))
  end function size_of_print
end module run_file_sizes
