!> Which fields an increment shall write, and their values on the nodes.
module requested_fields
  use kinds, only: rk
  use problem_definition, only: problem
  use analysis_state, only: state
  use joint_readings, only: opening_at_nodes
  use law_fields, only: is_field_of_law, width_of_field
  use run_records, only: run_record
  use result_writer, only: is_due
  use write_text, only: as_text
  implicit none
  private
  public :: list_due_fields, field_on_nodes, components_of, is_tensor

contains

  !> Fields of all requests that are due, each once; those that this procedure does not have are
  !> left out with one warning (of fields of materials, when the deck was read).
  subroutine list_due_fields(scene, now, record, fields)
    type(problem), intent(in) :: scene
    type(state), intent(in) :: now
    type(run_record), intent(inout) :: record
    character(8), allocatable, intent(out) :: fields(:)
    integer :: r, i
    allocate (fields(0))
    if (.not. allocated(scene%steps(now%step)%outputs)) return
    if (now%is_stop .and. any(mod(now%increment, max(1, scene%steps(now%step)%outputs%frequency)) &
                              == 0)) return
    do r = 1, size(scene%steps(now%step)%outputs)
      associate (request => scene%steps(now%step)%outputs(r))
        if (.not. is_due(now, request%frequency)) cycle
        do i = 1, size(request%fields)
          if (any(fields == request%fields(i))) cycle
          if (is_available(scene, now, request%fields(i))) then
            fields = [character(8) :: fields, request%fields(i)]
          else if (.not. is_field_of_law(request%fields(i))) then
            call record%warn_once('step '//scene%steps(now%step)%name//' has no field '// &
                                  trim(request%fields(i))//'; it is not written')
          end if
        end do
      end associate
    end do
  end subroutine list_due_fields

  !> Does this analysis have the field now?
  logical function is_available(scene, now, name)
    type(problem), intent(in) :: scene
    type(state), intent(in) :: now
    character(*), intent(in) :: name
    select case (name)
    case ('U', 'S', 'E', 'SP')
      is_available = .true.
    case ('RF')
      is_available = allocated(now%reaction)
    case ('V')
      is_available = allocated(now%v)
    case ('A')
      is_available = allocated(now%a)
    case ('OPENING')
      is_available = size(scene%joints) > 0
    case ('PE', 'DAMAGET', 'DAMAGEC', 'SDV')
      is_available = width_of_field(scene, name) > 0
    case default
      is_available = .false.
    end select
  end function is_available

  !> The values of a field on the nodes, tensors in the order 11 22 33 12 13 23.
  subroutine field_on_nodes(scene, now, record, name, values)
    type(problem), intent(in) :: scene
    type(state), intent(in) :: now
    type(run_record), intent(inout) :: record
    character(*), intent(in) :: name !< one that is available
    real(rk), allocatable, intent(out) :: values(:, :) !< (components, nodes)
    select case (name)
    case ('U')
      values = now%u
    case ('V')
      values = now%v
    case ('A')
      values = now%a
    case ('RF')
      values = now%reaction
    case ('S')
      call record%stresses%need_node_stress(scene, now)
      values = record%stresses%node_stress
    case ('E')
      call record%stresses%need_node_strain(scene, now)
      values = record%stresses%node_strain
    case ('SP')
      call record%stresses%need_principals(scene, now)
      values = record%stresses%node_principal
    case ('OPENING')
      values = reshape(opening_at_nodes(scene, now), [1, scene%mesh%num_nodes])
    case ('PE', 'DAMAGET', 'DAMAGEC', 'SDV')
      call record%stresses%field_on_nodes(scene, now, name, values)
    case default
      error stop 'field_on_nodes: a field that is not available'
    end select
  end subroutine field_on_nodes

  !> Is the field a symmetric tensor?
  pure elemental logical function is_tensor(name)
    character(*), intent(in) :: name
    is_tensor = name == 'S' .or. name == 'E' .or. name == 'PE'
  end function is_tensor

  !> Names of the components, with commas between, as `field_on_nodes` orders them; '' for one.
  pure function components_of(name, width) result(list)
    character(*), intent(in) :: name
    integer, intent(in) :: width !< how many
    character(:), allocatable :: list
    character(2), parameter :: suffix(6) = ['11', '22', '33', '12', '13', '23']
    integer :: i
    list = ''
    if (width == 1) return
    do i = 1, width
      if (is_tensor(name)) then
        list = list//','//trim(name)//suffix(i)
      else
        list = list//','//trim(name)//as_text(i)
      end if
    end do
    list = list(2:)
  end function components_of
end module requested_fields
