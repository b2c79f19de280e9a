!> *SPRING BOUNDARY: springs and dashpots between a surface and the ground; with a strength the
!> surface slides. The worked example of a guest: the contract of guest_type, a history of its own,
!> the keyword and its reader in one file.
!>
!> A node a of the surface gets the share A_a = int N_a dA of its area, and with the normal n there
!>   k_a = A_a (k_n n n^T + k_t (I - n n^T)),   c_a likewise with c_n and c_t.
!> With c_n = rho c_p and c_t = rho c_s the boundary absorbs plane waves that arrive along n (Lysmer
!> & Kuhlemeyer, J. Eng. Mech. Div. ASCE 95, 1969).
!>
!> With a strength tau the tangential force of a node is k_t A_a (u_t - s), at most tau A_a: beyond
!> it the slip s grows along the force. K_g u - f = k_t A_a s.
module spring_boundary
  use archive_type, only: archive
  use dam_mesh, only: fe_mesh, surface
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use dof_numbering, only: numbering
  use guest_history, only: history, stored_work
  use guest_type, only: damping_matrix, guest, offered_field, stiffness_matrix
  use keyword_spec, only: field, keyword, kind_real, kind_word
  use kinds, only: rk
  use matrix_pattern, only: pattern
  use mesh_faces, only: face_nodes
  use model_draft, only: add_guest, draft
  use named_things, only: find_surface_name, surface_names
  use nearest_words, only: nearest_word
  use scatter_matrix, only: scatter_blocks
  use shape_quad4, only: facet_point
  use write_text, only: as_text
  implicit none
  private
  public :: describe_spring_boundary, read_spring_boundary

  character, parameter :: nl = new_line('a')

  type, extends(guest) :: ground_springs
    real(rk) :: stiffness(2) = 0.0_rk !< k_n, k_t [Pa/m]
    real(rk) :: damping(2) = 0.0_rk !< c_n, c_t [Pa s/m]
    real(rk) :: strength = huge(1.0_rk) !< tau [Pa]
    real(rk), allocatable :: area(:, :) !< (3, nodes) area vectors of the surface at its nodes [m2]
  contains
    procedure :: has_matrix
    procedure :: add_matrix
    procedure :: add_supports
    procedure :: start_history
    procedure :: update
    procedure :: add_work
    procedure :: num_fields
    procedure :: describe_field
    procedure :: add_field
    procedure :: describe
  end type ground_springs

  !> What the springs change in time.
  type, extends(history) :: slip_history
    real(rk), allocatable :: moved(:, :) !< (3, nodes) tangential displacement [m]
    real(rk), allocatable :: slip(:, :) !< (3, nodes) [m]
    real(rk), allocatable :: work(:) !< (nodes) dissipated [J]
  contains
    procedure :: save => save_slip
    procedure :: load => load_slip
  end type slip_history

contains

  subroutine describe_spring_boundary(spec)
    type(keyword), intent(out) :: spec
    spec%name = 'SPRING BOUNDARY'
    spec%family = 'model'
    spec%place = 'model'
    spec%meaning = 'Springs and dashpots per area between a surface and the ground.'
    spec%example = '*SPRING BOUNDARY, NAME=ROCK, SURFACE=BASE'//nl//'1e9, 4e8, 6e6, 3.5e6'
    spec%fewest_lines = 1
    spec%most_lines = 1
    allocate (spec%parameters, source=[ &
              field('NAME', kind_word, 'name of the boundary', is_required=.true.), &
              field('SURFACE', kind_word, 'surface on the ground', is_required=.true.)])
    allocate (spec%columns, source=[ &
              field('normal stiffness', kind_real, 'springs along the normal', 'Pa/m', '0'), &
              field('tangential stiffness', kind_real, 'springs in the surface', 'Pa/m', '0'), &
              field('normal damping', kind_real, 'dashpots along the normal', 'Pa s/m', '0'), &
              field('tangential damping', kind_real, 'dashpots in the surface', 'Pa s/m', '0'), &
              field('strength', kind_real, 'largest tangential traction', 'Pa')])
    spec%columns%lowest = 0.0_rk
  end subroutine describe_spring_boundary

  subroutine read_spring_boundary(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(ground_springs) :: springs
    class(guest), allocatable :: item
    real(rk) :: given(5)
    integer :: found, i
    found = find_surface_name(model, this%word('SURFACE'))
    if (found == 0) then
      call this%fault_parameter(faults, 'SURFACE', "there is no surface '"// &
                                this%text('SURFACE')//"' above this line", &
                                'a surface defined above', &
                                nearest_word(this%word('SURFACE'), surface_names(model)))
      return
    end if
    given = [0.0_rk, 0.0_rk, 0.0_rk, 0.0_rk, huge(1.0_rk)]
    do i = 1, this%num_fields(1)
      if (.not. this%is_empty_at(1, i)) given(i) = this%real_at(1, i)
    end do
    springs%name = this%word('NAME')
    springs%kind = 'spring boundary'
    springs%stiffness = given(1:2)
    springs%damping = given(3:4)
    springs%strength = given(5)
    call share_area(model%problem%mesh, model%problem%surfaces(found), springs%area)
    allocate (item, source=springs)
    call add_guest(model, item)
  end subroutine read_spring_boundary

  !> A_a n of each node, by 2 x 2 Gauss points.
  subroutine share_area(mesh, faces, area)
    type(fe_mesh), intent(in) :: mesh
    type(surface), intent(in) :: faces
    real(rk), allocatable, intent(out) :: area(:, :) !< (3, nodes) [m2]
    real(rk) :: n(4), vector(3)
    integer :: i, q, a, nodes(4)
    allocate (area(3, mesh%num_nodes), source=0.0_rk)
    do i = 1, size(faces%element)
      nodes = face_nodes(mesh, faces%element(i), faces%face(i))
      do q = 1, 4
        call facet_point(mesh%x(:, nodes), q, n, vector)
        do a = 1, 4
          area(:, nodes(a)) = area(:, nodes(a)) + n(a)*vector
        end do
      end do
    end do
  end subroutine share_area

  !> Stiffness, and damping where the deck gives some.
  pure logical function has_matrix(self, kind)
    class(ground_springs), intent(in) :: self
    integer, intent(in) :: kind
    has_matrix = maxval(constants(self, kind)) > 0.0_rk
  end function has_matrix

  !> The two constants of a matrix.
  pure function constants(self, kind) result(k)
    class(ground_springs), intent(in) :: self
    integer, intent(in) :: kind
    real(rk) :: k(2) !< along the normal and across it
    k = 0.0_rk
    if (kind == stiffness_matrix) k = self%stiffness
    if (kind == damping_matrix) k = self%damping
  end function constants

  subroutine add_matrix(self, kind, mesh, numbers, matrix, values)
    class(ground_springs), intent(in) :: self
    integer, intent(in) :: kind
    type(fe_mesh), intent(in) :: mesh
    type(numbering), intent(in) :: numbers
    type(pattern), intent(in) :: matrix
    real(rk), intent(inout) :: values(:)
    real(rk) :: blocks(3, 3, mesh%num_nodes), k(2), size_of_area, n(3)
    integer :: node, i, j
    k = constants(self, kind)
    blocks = 0.0_rk
    do node = 1, mesh%num_nodes
      size_of_area = norm2(self%area(:, node))
      if (size_of_area <= 0.0_rk) cycle
      n = self%area(:, node)/size_of_area
      do j = 1, 3
        blocks(j, j, node) = size_of_area*k(2)
        do i = 1, 3
          blocks(i, j, node) = blocks(i, j, node) + size_of_area*(k(1) - k(2))*n(i)*n(j)
        end do
      end do
    end do
    call scatter_blocks(numbers, blocks, matrix, values)
  end subroutine add_matrix

  !> Springs in all directions support a model. With other springs the factorisation finds missing
  !> supports.
  subroutine add_supports(self, node, direction)
    class(ground_springs), intent(in) :: self
    integer, allocatable, intent(inout) :: node(:), direction(:)
    integer, allocatable :: own(:)
    integer :: a, i
    if (minval(self%stiffness) <= 0.0_rk) return
    own = pack([(a, a=1, size(self%area, 2))], norm2(self%area, 1) > 0.0_rk)
    do i = 1, 3
      node = [node, own]
      direction = [direction, spread(i, 1, size(own))]
    end do
  end subroutine add_supports

  !> Only springs with a strength have a history.
  subroutine start_history(self, mesh, own)
    class(ground_springs), intent(in) :: self
    type(fe_mesh), intent(in) :: mesh
    class(history), allocatable, intent(out) :: own
    type(slip_history) :: at_rest
    if (self%strength >= huge(1.0_rk)) return
    allocate (at_rest%moved(3, mesh%num_nodes), at_rest%slip(3, mesh%num_nodes), source=0.0_rk)
    allocate (at_rest%work(mesh%num_nodes), source=0.0_rk)
    allocate (own, source=at_rest)
  end subroutine start_history

  !> Return to the strength, node by node.
  subroutine update(self, mesh, u, dt, old, new, excess)
    class(ground_springs), intent(in) :: self
    type(fe_mesh), intent(in) :: mesh
    real(rk), intent(in) :: u(:, :)
    real(rk), intent(in) :: dt
    class(history), intent(in) :: old
    class(history), intent(inout) :: new
    real(rk), intent(inout) :: excess(:, :)
    real(rk) :: n(3), moved(3), elastic(3), area, beyond
    integer :: a
    select type (old)
    class is (slip_history)
      select type (new)
      class is (slip_history)
        do a = 1, mesh%num_nodes
          area = norm2(self%area(:, a))
          if (area <= 0.0_rk) cycle
          n = self%area(:, a)/area
          moved = u(:, a) - dot_product(n, u(:, a))*n
          elastic = moved - old%slip(:, a)
          beyond = max(0.0_rk, norm2(elastic) - self%strength/self%stiffness(2))
          new%moved(:, a) = moved
          new%slip(:, a) = old%slip(:, a)
          if (beyond > 0.0_rk) new%slip(:, a) = old%slip(:, a) + beyond*elastic/norm2(elastic)
          new%work(a) = old%work(a) + area*self%strength*beyond
          excess(:, a) = excess(:, a) + area*self%stiffness(2)*new%slip(:, a)
        end do
      end select
    end select
  end subroutine update

  !> Stored energy beyond 1/2 u K_g u, and the work of sliding.
  subroutine add_work(self, own, total)
    class(ground_springs), intent(in) :: self
    class(history), intent(in) :: own
    type(stored_work), intent(inout) :: total
    select type (own)
    class is (slip_history)
      total%stored = total%stored + 0.5_rk*self%stiffness(2)* &
                     sum(norm2(self%area, 1)*(sum((own%moved - own%slip)**2, 1) &
                                              - sum(own%moved**2, 1)))
      total%friction = total%friction + sum(own%work)
    end select
  end subroutine add_work

  pure integer function num_fields(self)
    class(ground_springs), intent(in) :: self
    num_fields = merge(1, 0, self%strength < huge(1.0_rk))
  end function num_fields

  subroutine describe_field(self, number, field)
    class(ground_springs), intent(in) :: self
    integer, intent(in) :: number
    type(offered_field), intent(out) :: field
    field%name = 'GROUND_SLIP'
    field%meaning = 'slip on the ground'
    field%unit = 'm'
    field%num_components = 3
  end subroutine describe_field

  subroutine add_field(self, number, own, values)
    class(ground_springs), intent(in) :: self
    integer, intent(in) :: number
    class(history), intent(in) :: own
    real(rk), intent(inout) :: values(:, :)
    select type (own)
    class is (slip_history)
      values = values + own%slip
    end select
  end subroutine add_field

  subroutine save_slip(self, file)
    class(slip_history), intent(in) :: self
    class(archive), intent(inout) :: file
    call file%put('moved', self%moved)
    call file%put('slip', self%slip)
    call file%put('work', self%work)
  end subroutine save_slip

  subroutine load_slip(self, file)
    class(slip_history), intent(inout) :: self
    class(archive), intent(inout) :: file
    call file%get('moved', self%moved)
    call file%get('slip', self%slip)
    call file%get('work', self%work)
  end subroutine load_slip

  function describe(self) result(text)
    class(ground_springs), intent(in) :: self
    character(:), allocatable :: text
    text = 'springs to the ground on '//as_text(count(norm2(self%area, 1) > 0.0_rk))//' nodes'
  end function describe
end module spring_boundary
