!> Builds the equations of *EQUATION and *MPC after the whole deck is read: their first terms must
!> be free of supports, ties and other equations.
module finish_equations
  use coupling_equation, only: equation_set
  use dam_mesh, only: node_tie
  use deck_card, only: card
  use deck_scan, only: is_keyword
  use diagnostics, only: diagnostic_list, place
  use errors, only: error_type
  use guest_list, only: ties_of
  use guest_type, only: guest
  use kinds, only: rk
  use base_motion_cards, only: directions_of_motion
  use model_draft, only: add_guest, draft
  use named_things, only: nodes_at
  use node_dofs, only: num_directions, zero_vectors
  use tie_motion, only: follow_ties
  use write_text, only: as_text
  implicit none
  private
  public :: complete_equations

  !> Coefficients that add up to less than this fraction of the largest cancel each other.
  real(rk), parameter :: round_off = 1.0e-12_rk

contains

  !> Checks all equations and makes the guest that imposes them. The ties must be built.
  subroutine complete_equations(model, faults)
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(equation_set) :: new
    class(guest), allocatable :: item
    integer, allocatable :: owner(:, :)
    if (model%equations%num == 0) return
    call solve_for_first(model, faults, new%rows)
    call claim_first(model, new%rows, faults, owner)
    call refuse_supports(model, owner, faults)
    call refuse_ties(model, owner, faults)
    call refuse_initial_values(model, owner, faults)
    call refuse_base_motion(model, faults)
    if (faults%has_errors()) return
    new%name = 'EQUATIONS'
    new%kind = 'equation'
    new%rows%name = 'EQUATIONS'
    call refuse_circles(model, owner, new%rows, faults)
    allocate (item, source=new)
    call add_guest(model, item)
  end subroutine complete_equations

  !> Each equation as the first displacement in terms of the others.
  subroutine solve_for_first(model, faults, rows)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(node_tie), intent(out) :: rows
    integer :: k, t, used, first, last
    real(rk) :: own
    associate (list => model%equations)
      last = list%first(list%num + 1) - 1
      allocate (rows%node(list%num), rows%first(list%num + 1), rows%item(last))
      allocate (rows%item_direction(last), rows%weight(last))
      allocate (rows%is_tied(num_directions, list%num), source=.false.)
      used = 0
      rows%first(1) = 1
      do k = 1, list%num
        first = list%first(k)
        last = list%first(k + 1) - 1
        rows%node(k) = list%node(first)
        rows%is_tied(list%direction(first), k) = .true.
        own = 0.0_rk
        do t = first, last
          if (is_same_dof(t, first)) then
            own = own + list%coefficient(t)
          else if (abs(list%coefficient(t)) > 0.0_rk) then
            used = used + 1
            rows%item(used) = list%node(t)
            rows%item_direction(used) = list%direction(t)
            rows%weight(used) = -list%coefficient(t)
          end if
        end do
        rows%first(k + 1) = used + 1
        if (abs(own) <= round_off*maxval(abs(list%coefficient(first:last)))) then
          call fault(model, k, 'the coefficients of the first displacement add up to zero', &
                     'a first term that depends on the others', faults)
        else if (used < rows%first(k)) then
          call fault(model, k, 'the equation holds one displacement', '*BOUNDARY', faults)
        else
          rows%weight(rows%first(k):used) = rows%weight(rows%first(k):used)/own
        end if
      end do
    end associate
    rows%item = rows%item(:used)
    rows%item_direction = rows%item_direction(:used)
    rows%weight = rows%weight(:used)
  contains
    !> Whether two terms are one displacement.
    pure logical function is_same_dof(a, b)
      integer, intent(in) :: a, b
      is_same_dof = model%equations%node(a) == model%equations%node(b) .and. &
                    model%equations%direction(a) == model%equations%direction(b)
    end function is_same_dof
  end subroutine solve_for_first

  !> The equation of each displacement that is a first term, 0 for none.
  subroutine claim_first(model, rows, faults, owner)
    type(draft), intent(in) :: model
    type(node_tie), intent(in) :: rows
    type(diagnostic_list), intent(inout) :: faults
    integer, allocatable, intent(out) :: owner(:, :) !< (3, nodes)
    integer :: k, i
    allocate (owner(num_directions, model%problem%mesh%num_nodes), source=0)
    do k = 1, size(rows%node)
      i = findloc(rows%is_tied(:, k), .true., dim=1)
      if (owner(i, rows%node(k)) > 0) then
        call fault(model, k, displacement(model, rows%node(k), i)//' is the first term of two '// &
                   'equations', 'one equation for each first term', faults, &
                   place_of(model, owner(i, rows%node(k))))
      else
        owner(i, rows%node(k)) = k
      end if
    end do
  end subroutine claim_first

  !> First terms that a support of any step holds.
  subroutine refuse_supports(model, owner, faults)
    type(draft), intent(in) :: model
    integer, intent(in) :: owner(:, :) !< (3, nodes)
    type(diagnostic_list), intent(inout) :: faults
    logical :: is_reported(model%equations%num)
    integer :: s, i
    is_reported = .false.
    do s = 1, size(model%problem%steps)
      associate (fixities => model%problem%steps(s)%fixities)
        do i = 1, size(fixities)
          associate (k => owner(fixities(i)%dof, fixities(i)%node))
            if (k == 0) cycle
            if (is_reported(k)) cycle
            is_reported(k) = .true.
            call fault(model, k, displacement(model, fixities(i)%node, fixities(i)%dof)// &
                       ' is the first term and has a support', &
                       'another displacement of the equation as its first term', faults, &
                       place_of_support(model, fixities(i)%node, fixities(i)%dof))
          end associate
        end do
      end associate
    end do
  end subroutine refuse_supports

  !> First terms that a tie makes follow others.
  subroutine refuse_ties(model, owner, faults)
    type(draft), intent(in) :: model
    integer, intent(in) :: owner(:, :) !< (3, nodes)
    type(diagnostic_list), intent(inout) :: faults
    type(node_tie), allocatable :: ties(:)
    integer :: t, k, i, request
    call ties_of(model%problem%guests, ties)
    do t = 1, size(ties)
      do request = 1, size(model%ties)
        if (model%ties(request)%name == ties(t)%name) exit
      end do
      do k = 1, size(ties(t)%node)
        do i = 1, num_directions
          if (.not. ties(t)%is_tied(i, k) .or. owner(i, ties(t)%node(k)) == 0) cycle
          call fault(model, owner(i, ties(t)%node(k)), displacement(model, ties(t)%node(k), i)// &
                     " is the first term and follows others by tie '"//ties(t)%name//"'", &
                     'another displacement of the equation as its first term', faults, &
                     model%cards(model%ties(request)%spot%card)%place())
          return
        end do
      end do
    end do
  end subroutine refuse_ties

  !> Initial values of first terms follow from those of the others.
  subroutine refuse_initial_values(model, owner, faults)
    type(draft), intent(in) :: model
    integer, intent(in) :: owner(:, :) !< (3, nodes)
    type(diagnostic_list), intent(inout) :: faults
    integer :: i
    do i = 1, size(model%problem%initial_values)
      associate (given => model%problem%initial_values(i))
        if (owner(given%dof, given%node) == 0) cycle
        call fault(model, owner(given%dof, given%node), &
                   displacement(model, given%node, given%dof)// &
                   ' is the first term and has an initial value', &
                   'initial values of the other terms', faults)
        return
      end associate
    end do
  end subroutine refuse_initial_values

  !> A motion of the base moves all nodes alike in one direction. An equation that it breaks would
  !> have to hold relative to a point at rest (different_meshes.md, 13.10).
  subroutine refuse_base_motion(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    integer :: c, direction
    logical :: moves(num_directions)
    do c = 1, size(model%cards)
      moves = directions_of_motion(model%cards(c))
      do direction = 1, num_directions
        if (moves(direction)) call refuse_motion(model, c, direction, faults)
        if (faults%has_errors()) return
      end do
    end do
  end subroutine refuse_base_motion

  !> Refuses the first equation that a motion of the base in a direction breaks.
  subroutine refuse_motion(model, number, direction, faults)
    type(draft), intent(in) :: model
    integer, intent(in) :: number, direction !< of the card of the motion
    type(diagnostic_list), intent(inout) :: faults
    real(rk) :: total
    integer :: k
    do k = 1, model%equations%num
      associate (first => model%equations%first(k), last => model%equations%first(k + 1) - 1)
        associate (coefficient => model%equations%coefficient(first:last))
          total = sum(coefficient, mask=model%equations%direction(first:last) == direction)
          if (abs(total) <= round_off*maxval(abs(coefficient))) cycle
        end associate
      end associate
      call fault(model, k, 'a motion of the base along '//'xyz' (direction:direction)// &
                 ' breaks the equation', 'coefficients of this direction that add up to zero', &
                 faults, model%cards(number)%place())
      return
    end do
  end subroutine refuse_motion

  !> Displacements that depend on each other in a circle.
  subroutine refuse_circles(model, owner, rows, faults)
    type(draft), intent(in) :: model
    integer, intent(in) :: owner(:, :) !< (3, nodes)
    type(node_tie), intent(in) :: rows
    type(diagnostic_list), intent(inout) :: faults
    type(node_tie), allocatable :: ties(:)
    type(error_type), allocatable :: error
    real(rk), allocatable :: field(:, :)
    integer :: in_circle, next
    call ties_of(model%problem%guests, ties)
    ties = [ties, rows]
    field = zero_vectors(model%problem%mesh%num_nodes)
    call follow_ties(ties, field, error)
    if (.not. allocated(error)) return
    call find_circle(owner, rows, in_circle, next)
    if (in_circle > 0) then
      call fault(model, in_circle, 'the equations depend on each other in a circle', &
                 'first terms that do not follow from each other', faults, place_of(model, next))
    else
      call fault(model, 1, 'equations and ties: '//error%message, &
                 'first terms that no tie makes follow', faults, &
                 model%cards(model%ties(1)%spot%card)%place())
    end if
  end subroutine refuse_circles

  !> An equation of a circle and the one that it depends on; 0 without a circle of equations.
  subroutine find_circle(owner, rows, in_circle, next)
    integer, intent(in) :: owner(:, :) !< (3, nodes)
    type(node_tie), intent(in) :: rows
    integer, intent(out) :: in_circle, next
    logical :: is_open(size(rows%node)), has_changed
    integer :: k, step
    is_open = .true.
    has_changed = .true.
    do while (has_changed)
      has_changed = .false.
      do k = 1, size(is_open)
        if (.not. is_open(k)) cycle
        if (open_one(k) > 0) cycle
        is_open(k) = .false.
        has_changed = .true.
      end do
    end do
    in_circle = findloc(is_open, .true., dim=1)
    next = in_circle
    do step = 1, merge(size(is_open), 0, in_circle > 0)
      in_circle = next
      next = open_one(in_circle)
    end do
  contains
    !> An open equation that equation k depends on, 0 for none.
    pure integer function open_one(k) result(other)
      integer, intent(in) :: k
      integer :: t
      do t = rows%first(k), rows%first(k + 1) - 1
        other = owner(rows%item_direction(t), rows%item(t))
        if (other == 0) cycle
        if (is_open(other)) return
      end do
      other = 0
    end function open_one
  end subroutine find_circle

  !> 'node 12, displacement along x'.
  pure function displacement(model, node, direction) result(text)
    type(draft), intent(in) :: model
    integer, intent(in) :: node, direction
    character(:), allocatable :: text
    text = 'the displacement of node '//as_text(model%problem%mesh%node_id(node))//' along '// &
           'xyz' (direction:direction)
  end function displacement

  !> Reports a fault at an equation.
  subroutine fault(model, number, problem, expected, faults, first)
    type(draft), intent(in) :: model
    integer, intent(in) :: number !< of the equation
    character(*), intent(in) :: problem, expected
    type(diagnostic_list), intent(inout) :: faults
    type(place), intent(in), optional :: first !< the place that it clashes with
    call model%cards(model%equations%card(number))%fault_at( &
      faults, model%equations%line(number), 1, problem, expected, first=first)
  end subroutine fault

  type(place) function place_of(model, number)
    type(draft), intent(in) :: model
    integer, intent(in) :: number !< of the equation
    place_of = model%cards(model%equations%card(number))%place_at(model%equations%line(number), 1)
  end function place_of

  !> The line of a *BOUNDARY that holds a displacement.
  type(place) function place_of_support(model, node, direction) result(spot)
    type(draft), intent(in) :: model
    integer, intent(in) :: node, direction
    type(diagnostic_list) :: dropped
    integer, allocatable :: nodes(:)
    integer :: c, line, ends(2)
    do c = 1, size(model%cards)
      if (.not. is_keyword(model%cards(c), 'BOUNDARY')) cycle
      do line = 1, model%cards(c)%num_lines
        spot = model%cards(c)%place_at(line, 1)
        ends = [1, num_directions]
        if (model%cards(c)%is_integer_at(line, 2)) ends = model%cards(c)%integer_at(line, 2)
        if (model%cards(c)%is_integer_at(line, 3)) ends(2) = model%cards(c)%integer_at(line, 3)
        if (direction < ends(1) .or. direction > ends(2)) cycle
        call nodes_at(model%cards(c), line, 1, model, dropped, nodes)
        if (any(nodes == node)) return
      end do
    end do
  end function place_of_support
end module finish_equations
