!> *SPRING BOUNDARY: springs and dashpots between a surface and the ground. The worked example of a
!> guest: the contract of guest_type, the keyword and its reader in one file.
!>
!> A node a of the surface gets the share A_a = int N_a dA of its area, and with the normal n there
!>   k_a = A_a (k_n n n^T + k_t (I - n n^T)),   c_a likewise with c_n and c_t.
!> With c_n = rho c_p and c_t = rho c_s the boundary absorbs plane waves that arrive along n (Lysmer
!> & Kuhlemeyer, J. Eng. Mech. Div. ASCE 95, 1969).
module spring_boundary
  use dam_mesh, only: fe_mesh, surface
  use deck_card, only: card
  use diagnostics, only: diagnostic_list
  use dof_numbering, only: numbering
  use guest_type, only: damping_matrix, guest, stiffness_matrix
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
    real(rk), allocatable :: area(:, :) !< (3, nodes) area vectors of the surface at its nodes [m2]
  contains
    procedure :: has_matrix
    procedure :: add_matrix
    procedure :: add_supports
    procedure :: describe
  end type ground_springs

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
              field('tangential damping', kind_real, 'dashpots in the surface', 'Pa s/m', '0')])
    spec%columns%lowest = 0.0_rk
  end subroutine describe_spring_boundary

  subroutine read_spring_boundary(this, model, faults)
    type(card), intent(in) :: this
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(ground_springs) :: springs
    class(guest), allocatable :: item
    real(rk) :: given(4)
    integer :: found, i
    found = find_surface_name(model, this%word('SURFACE'))
    if (found == 0) then
      call this%fault_parameter(faults, 'SURFACE', "there is no surface '"// &
                                this%text('SURFACE')//"' so far", 'a surface defined above', &
                                nearest_word(this%word('SURFACE'), surface_names(model)))
      return
    end if
    given = 0.0_rk
    do i = 1, this%num_fields(1)
      if (.not. this%is_empty_at(1, i)) given(i) = this%real_at(1, i)
    end do
    springs%name = this%word('NAME')
    springs%kind = 'spring boundary'
    springs%stiffness = given(1:2)
    springs%damping = given(3:4)
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

  function describe(self) result(text)
    class(ground_springs), intent(in) :: self
    character(:), allocatable :: text
    text = 'springs to the ground on '//as_text(count(norm2(self%area, 1) > 0.0_rk))//' nodes'
  end function describe
end module spring_boundary
