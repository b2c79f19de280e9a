!> Fields of the laws of inelastic solids (PE, DAMAGET, ...). In elastic solids, and where a law
!> does not have the field, the field is zero.
module law_fields
  use kinds, only: rk
  use material_law, only: stress_law
  use material_points, only: point_state
  use problem_definition, only: problem
  use analysis_state, only: state
  use recovery_plans, only: fewest_for_threads, max_points, recovery_plan
  implicit none
  private
  public :: width_of_field, field_of_block, field_at_points, take_block, mean_of_elements
  public :: find_inelastic_solids, nodes_of_solids, is_zero_while_elastic

contains

  !> Largest number of components of a field among the laws; 0 where no law has the field.
  integer function width_of_field(model, name) result(width)
    type(problem), intent(in) :: model
    character(*), intent(in) :: name
    type(point_state) :: nobody
    real(rk), allocatable :: values(:, :)
    integer :: i, last
    width = 0
    if (.not. allocated(model%inelastic)) return
    last = 0
    allocate (nobody%strain(6, 0), nobody%stress(6, 0), nobody%energy(3, 0), nobody%is_elastic(0))
    do i = 1, size(model%inelastic)
      if (model%inelastic(i)%material == last) cycle
      last = model%inelastic(i)%material
      associate (law => model%materials(last)%law)
        if (allocated(nobody%internal)) deallocate (nobody%internal)
        allocate (nobody%internal(law%num_state, 0))
        call read_law(law, name, nobody, values)
      end associate
      if (allocated(values)) width = max(width, size(values, 1))
    end do
  end function width_of_field

  !> A field of a law. PEMAG follows from its plastic strain.
  subroutine read_law(law, name, points, values)
    class(stress_law), intent(in) :: law
    character(*), intent(in) :: name
    type(point_state), intent(in) :: points
    real(rk), allocatable, intent(out) :: values(:, :) !< (components, points), or unallocated
    real(rk), allocatable :: plastic(:, :)
    if (name /= 'PEMAG') then
      call law%read_field(name, points, values)
      return
    end if
    call law%read_field('PE', points, plastic)
    if (.not. allocated(plastic)) return
    allocate (values(1, size(plastic, 2)))
    values(1, :) = sqrt((2.0_rk*sum(plastic(:3, :)**2, 1) + sum(plastic(4:, :)**2, 1))/3.0_rk)
  end subroutine read_law

  !> False for state variables: a law may change them while a point is elastic.
  pure logical function is_zero_while_elastic(name)
    character(*), intent(in) :: name
    is_zero_while_elastic = name /= 'SDV'
  end function is_zero_while_elastic

  !> A field at the points of an inelastic block; unallocated where the field is zero: the law does
  !> not have the field, or no point has left elasticity.
  subroutine field_of_block(model, now, block, name, values)
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    integer, intent(in) :: block !< position in the problem's list
    character(*), intent(in) :: name
    real(rk), allocatable, intent(out) :: values(:, :) !< (components, points)
    if (is_zero_while_elastic(name) .and. all(now%points(block)%is_elastic)) return
    associate (law => model%materials(model%inelastic(block)%material)%law)
      call read_law(law, name, now%points(block), values)
    end associate
  end subroutine field_of_block

  !> A field at the points of all solids.
  subroutine field_at_points(model, plan, now, name, values)
    type(problem), intent(in) :: model
    type(recovery_plan), intent(in) :: plan
    type(state), intent(in) :: now
    character(*), intent(in) :: name
    real(rk), allocatable, intent(out) :: values(:, :, :) !< (components, max_points, solids)
    integer :: i
    allocate (values(width_of_field(model, name), max_points, plan%num_solids), source=0.0_rk)
    !$omp parallel do default(none) shared(model, plan, now, name, values) schedule(dynamic, 8) &
    !$omp if (plan%num_solids > fewest_for_threads)
    do i = 1, size(model%inelastic)
      call spread_block(model, plan, now, i, name, values)
    end do
    !$omp end parallel do
  end subroutine field_at_points

  !> Writes a field of one block at its solids; zero fields are left out.
  subroutine spread_block(model, plan, now, block, name, values)
    type(problem), intent(in) :: model
    type(recovery_plan), intent(in) :: plan
    type(state), intent(in) :: now
    integer, intent(in) :: block !< position in the problem's list
    character(*), intent(in) :: name
    real(rk), intent(inout) :: values(:, :, :) !< (components, max_points, solids)
    real(rk), allocatable :: of_block(:, :)
    integer :: e, s, n
    call field_of_block(model, now, block, name, of_block)
    if (.not. allocated(of_block)) return
    n = model%inelastic(block)%points_of_element
    do e = 1, size(model%inelastic(block)%elements)
      s = plan%solid_of_element(model%inelastic(block)%elements(e))
      values(:size(of_block, 1), :n, s) = of_block(:, (e - 1)*n + 1:e*n)
    end do
  end subroutine spread_block

  !> A component of values at the points of all solids, at the points of an inelastic block.
  pure subroutine take_block(model, plan, block, at_points, values)
    type(problem), intent(in) :: model
    type(recovery_plan), intent(in) :: plan
    integer, intent(in) :: block !< position in the problem's list
    real(rk), intent(in) :: at_points(:, :) !< (max_points, solids)
    real(rk), allocatable, intent(out) :: values(:, :) !< (1, points)
    integer :: e, n
    associate (own => model%inelastic(block))
      n = own%points_of_element
      allocate (values(1, n*size(own%elements)))
      do e = 1, size(own%elements)
        values(1, (e - 1)*n + 1:e*n) = at_points(:n, plan%solid_of_element(own%elements(e)))
      end do
    end associate
  end subroutine take_block

  !> The mean of a scalar field over the volume of each element; zero in elastic solids.
  subroutine mean_of_elements(model, now, name, mean)
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    character(*), intent(in) :: name
    real(rk), allocatable, intent(out) :: mean(:) !< (elements of the mesh)
    integer :: i
    allocate (mean(model%mesh%num_elements), source=0.0_rk)
    !$omp parallel do default(none) shared(model, now, name, mean) schedule(dynamic, 8) &
    !$omp if (model%mesh%num_elements > fewest_for_threads)
    do i = 1, size(model%inelastic)
      call mean_of_block(model, now, i, name, mean)
    end do
    !$omp end parallel do
  end subroutine mean_of_elements

  !> The means of the elements of one block; zero fields are left out.
  subroutine mean_of_block(model, now, block, name, mean)
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    integer, intent(in) :: block !< position in the problem's list
    character(*), intent(in) :: name
    real(rk), intent(inout) :: mean(:) !< (elements of the mesh)
    real(rk), allocatable :: values(:, :)
    integer :: e, n
    call field_of_block(model, now, block, name, values)
    if (.not. allocated(values)) return
    associate (part => model%inelastic(block))
      n = part%points_of_element
      do e = 1, size(part%elements)
        mean(part%elements(e)) = sum(part%weight(:, e)*values(1, (e - 1)*n + 1:e*n)) &
                                 /sum(part%weight(:, e))
      end do
    end associate
  end subroutine mean_of_block

  !> The solids with a point that has left elasticity.
  subroutine find_inelastic_solids(model, plan, now, is_inelastic)
    type(problem), intent(in) :: model
    type(recovery_plan), intent(in) :: plan
    type(state), intent(in) :: now
    logical, allocatable, intent(out) :: is_inelastic(:) !< (solids)
    integer :: i, e, n
    allocate (is_inelastic(plan%num_solids), source=.false.)
    if (.not. allocated(model%inelastic)) return
    !$omp parallel do default(none) shared(model, plan, now, is_inelastic) private(e, n) &
    !$omp schedule(dynamic, 8) if (plan%num_solids > fewest_for_threads)
    do i = 1, size(model%inelastic)
      n = model%inelastic(i)%points_of_element
      do e = 1, size(model%inelastic(i)%elements)
        is_inelastic(plan%solid_of_element(model%inelastic(i)%elements(e))) = &
          .not. all(now%points(i)%is_elastic((e - 1)*n + 1:e*n))
      end do
    end do
    !$omp end parallel do
  end subroutine find_inelastic_solids

  !> The nodes whose means include chosen solids.
  pure function nodes_of_solids(plan, is_chosen) result(nodes)
    type(recovery_plan), intent(in) :: plan
    logical, intent(in) :: is_chosen(:) !< (solids)
    integer, allocatable :: nodes(:)
    integer, allocatable :: found(:)
    integer :: node, i, last
    allocate (found(size(plan%node_start) - 1))
    last = 0
    do node = 1, size(found)
      do i = plan%node_start(node), plan%node_start(node + 1) - 1
        if (.not. is_chosen((plan%corner(i) - 1)/8 + 1)) cycle
        last = last + 1
        found(last) = node
        exit
      end do
    end do
    nodes = found(:last)
  end function nodes_of_solids
end module law_fields
