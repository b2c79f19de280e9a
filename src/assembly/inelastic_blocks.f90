!> Solid elements whose stress is not a constant stiffness times strain, in blocks of one kind and
!> one material. Laws are called and histories are stored by block. Models of elastic solids have no
!> such block.
module inelastic_blocks
  use crack_band, only: extreme_widths
  use kinds, only: rk
  use dam_mesh, only: fe_mesh
  use element_catalogue, only: is_solid, make_solid
  use element_formulation, only: solid_element, strains_of_element
  use gauss_rules, only: hex_point
  use guest_history, only: history, stored_work
  use guest_type, only: guest
  use material_law, only: material
  use material_points, only: point_set, point_state, stored_energy, fracture_energy, &
                             crushing_energy, make_room
  use ranks, only: this_rank
  use shape_hex8, only: edges_at, hex8_dofs, shape_at
  use slope_products, only: add_forces_of_stress, find_symmetric_gradient
  implicit none
  private
  public :: inelastic_block, list_inelastic_blocks, fewest_blocks

  integer, parameter :: largest_block = 16 !< elements; their points fit the cache of a core
  integer, parameter :: fewest_blocks = 100 !< from which several threads read results or energies

  type, extends(guest) :: inelastic_block
    integer :: material = 0 !< position in the problem's list
    integer, allocatable :: elements(:) !< positions in the mesh
    integer :: rank = 0 !< that calls the law of its points
    integer :: points_of_element = 0
    !> (8 points, 3, 8, elements) derivatives of the shape functions, where they alone make the
    !> strain operators [1/m]
    real(rk), allocatable :: slope(:, :, :, :)
    !> (6, 24, points, elements) strain operators of other elements, six times as many numbers [1/m]
    real(rk), allocatable :: b(:, :, :, :)
    real(rk), allocatable :: weight(:, :) !< (points, elements) volumes of the points [m3]
    real(rk) :: d(6, 6) = 0.0_rk !< elastic stiffness of the law [Pa]
    type(point_set) :: points !< point q of element e is (e - 1)*points_of_element + q
  contains
    procedure :: add_work
    procedure :: find_strains, add_forces, find_operator, num_points, forget_points, is_here
  end type inelastic_block

contains

  !> Sorts the elements with nonlinear laws into blocks; size 0 for none. The Jacobian of all
  !> elements must be positive.
  subroutine list_inelastic_blocks(mesh, materials, blocks, class_of)
    type(fe_mesh), intent(in) :: mesh
    type(material), intent(in) :: materials(:)
    type(inelastic_block), allocatable, intent(out) :: blocks(:)
    !> (elements) those of one block have the same; they come and go together
    integer, intent(in), optional :: class_of(:)
    integer, allocatable :: group(:)
    logical, allocatable :: is_pending(:)
    integer :: e, m, first, last, num_blocks
    allocate (is_pending(mesh%num_elements), source=.false.)
    do m = 1, size(materials)
      if (.not. allocated(materials(m)%law)) cycle
      if (.not. materials(m)%law%is_nonlinear) cycle
      is_pending = is_pending .or. &
                   (is_solid(mesh%element_type) .and. mesh%material_of_element == m)
    end do
    allocate (blocks(count(is_pending)))
    num_blocks = 0
    do while (any(is_pending))
      first = findloc(is_pending, .true., 1)
      group = pack([(e, e=1, mesh%num_elements)], is_pending .and. &
                   mesh%material_of_element == mesh%material_of_element(first) .and. &
                   mesh%element_type == mesh%element_type(first))
      if (present(class_of)) group = pack(group, class_of(group) == class_of(first))
      is_pending(group) = .false.
      do first = 1, size(group), largest_block
        last = min(size(group), first + largest_block - 1)
        num_blocks = num_blocks + 1
        call build_block(mesh, materials, group(first:last), blocks(num_blocks))
      end do
    end do
    blocks = blocks(:num_blocks)
  end subroutine list_inelastic_blocks

  !> Operators and points of some elements of one kind and one material.
  subroutine build_block(mesh, materials, elements, part)
    type(fe_mesh), intent(in) :: mesh
    type(material), intent(in) :: materials(:)
    integer, intent(in) :: elements(:)
    type(inelastic_block), intent(out) :: part
    class(solid_element), allocatable :: formulation
    real(rk) :: x(3, 8, size(elements))
    integer :: status(size(elements)), e
    part%material = mesh%material_of_element(elements(1))
    part%name = materials(part%material)%name
    part%kind = 'inelastic'
    part%elements = elements
    call make_solid(mesh%element_type(elements(1)), formulation)
    part%points_of_element = formulation%num_points
    do e = 1, size(elements)
      x(:, :, e) = mesh%x(:, mesh%nodes(:, elements(e)))
    end do
    allocate (part%b(6, hex8_dofs, part%points_of_element, size(elements)), &
              part%weight(part%points_of_element, size(elements)))
    call materials(part%material)%law%elastic_stiffness(part%d)
    call formulation%strain_operator(x, part%d, part%b, part%weight, status)
    call find_slopes(part)
    call place_points(mesh%element_id(elements), x, part)
  end subroutine build_block

  !> Takes the derivatives of the shape functions from the strain operators of eight points, in the
  !> place of the operators.
  pure subroutine find_slopes(part)
    type(inelastic_block), intent(inout) :: part
    real(rk) :: g(3)
    integer :: e, a, q, n
    if (part%points_of_element /= 8) return
    allocate (part%slope(8, 3, 8, size(part%b, 4)))
    do e = 1, size(part%b, 4)
      do a = 1, 8
        n = 3*a - 2
        do q = 1, size(part%b, 3)
          g = [part%b(1, n, q, e), part%b(2, n + 1, q, e), part%b(3, n + 2, q, e)]
          part%slope(q, :, a, e) = g
          if (any(abs(part%b(:, n:n + 2, q, e) - operator_of_slopes(g)) > 0.0_rk)) then
            deallocate (part%slope)
            return
          end if
        end do
      end do
    end do
    deallocate (part%b)
  end subroutine find_slopes

  !> Strain operator of a node from the derivatives of its shape function.
  pure function operator_of_slopes(g) result(b)
    real(rk), intent(in) :: g(3) !< [1/m]
    real(rk) :: b(6, 3) !< [1/m]
    b(:, 1) = [g(1), 0.0_rk, 0.0_rk, g(2), g(3), 0.0_rk]
    b(:, 2) = [0.0_rk, g(2), 0.0_rk, g(1), 0.0_rk, g(3)]
    b(:, 3) = [0.0_rk, 0.0_rk, g(3), 0.0_rk, g(1), g(2)]
  end function operator_of_slopes

  !> B at a point of one element.
  pure subroutine find_operator(self, e, q, b)
    class(inelastic_block), intent(in) :: self
    integer, intent(in) :: e, q
    real(rk), intent(out) :: b(6, hex8_dofs) !< [1/m]
    integer :: a
    if (allocated(self%b)) then
      b = self%b(:, :, q, e)
      return
    end if
    do a = 1, 8
      b(:, 3*a - 2:3*a) = operator_of_slopes(self%slope(q, :, a, e))
    end do
  end subroutine find_operator

  !> eps = B u at the points of one element.
  pure subroutine find_strains(self, e, u, strain)
    class(inelastic_block), intent(in) :: self
    integer, intent(in) :: e
    real(rk), intent(in) :: u(hex8_dofs) !< [m]
    real(rk), intent(out) :: strain(6, self%points_of_element)
    if (allocated(self%slope)) then
      call find_symmetric_gradient(self%slope(:, :, :, e), u, strain)
    else
      call strains_of_element(self%b(:, :, :, e), u, strain)
    end if
  end subroutine find_strains

  !> Adds sum B^T sigma of one element.
  pure subroutine add_forces(self, e, stress, force)
    class(inelastic_block), intent(in) :: self
    integer, intent(in) :: e
    real(rk), intent(in) :: stress(self%points_of_element, 6) !< times volumes of points [N m]
    real(rk), intent(inout) :: force(hex8_dofs) !< [N]
    integer :: q, i
    if (allocated(self%slope)) then
      call add_forces_of_stress(self%slope(:, :, :, e), stress, force)
      return
    end if
    do q = 1, self%points_of_element
      do i = 1, hex8_dofs
        force(i) = force(i) + sum(self%b(:, i, q, e)*stress(q, :))
      end do
    end do
  end subroutine add_forces

  !> Numbers and places of the points.
  subroutine place_points(id, x, part)
    integer, intent(in) :: id(:) !< user's numbers of the elements
    real(rk), intent(in) :: x(:, :, :) !< (3, 8, elements) [m]
    type(inelastic_block), intent(inout) :: part
    real(rk) :: xi(3), smallest
    integer :: e, q, p, n
    n = part%points_of_element*size(id)
    associate (points => part%points)
      call make_room(points, n)
      do e = 1, size(id)
        do q = 1, part%points_of_element
          p = (e - 1)*part%points_of_element + q
          xi = 0.0_rk
          if (part%points_of_element > 1) xi = hex_point(:, q)
          points%element(p) = id(e)
          points%number(p) = q
          points%x(:, p) = matmul(x(:, :, e), shape_at(xi))
          points%edges(:, :, p) = edges_at(x(:, :, e), xi)
          call extreme_widths(points%edges(:, :, p), smallest, points%widest(p))
          points%length(p) = sum(part%weight(:, e))**(1.0_rk/3.0_rk)
        end do
      end do
    end associate
  end subroutine place_points

  !> Whether this rank calls the law.
  pure logical function is_here(self)
    class(inelastic_block), intent(in) :: self
    is_here = self%rank == this_rank()
  end function is_here

  !> Points of the elements, wherever they are.
  pure integer function num_points(self)
    class(inelastic_block), intent(in) :: self
    num_points = self%points_of_element*size(self%elements)
  end function num_points

  !> Frees the tables of points that are on another rank.
  pure subroutine forget_points(self)
    class(inelastic_block), intent(inout) :: self
    if (allocated(self%slope)) deallocate (self%slope)
    if (allocated(self%b)) deallocate (self%b)
    self%weight = reshape([real(rk) ::], [self%points_of_element, 0])
    call make_room(self%points, 0)
  end subroutine forget_points

  !> Energies of the points that have yielded or cracked; all others contribute nothing. Points of
  !> other ranks contribute nothing here.
  subroutine add_work(self, own, total)
    class(inelastic_block), intent(in) :: self
    class(history), intent(in) :: own
    type(stored_work), intent(inout) :: total
    integer :: e, q, p
    select type (own)
    class is (point_state)
      if (.not. self%is_here() .or. all(own%is_elastic)) return
      do e = 1, size(self%elements)
        do q = 1, self%points_of_element
          p = (e - 1)*self%points_of_element + q
          if (own%is_elastic(p)) cycle
          associate (strain => own%strain(:, p), energy => own%energy(:, p), &
                     volume => self%weight(q, e))
            total%stored = total%stored + volume*(energy(stored_energy) - 0.5_rk &
                                                  *dot_product(strain, matmul(self%d, strain)))
            total%fracture = total%fracture &
                             + volume*(energy(fracture_energy) + energy(crushing_energy))
            total%crushing = total%crushing + volume*energy(crushing_energy)
          end associate
        end do
      end do
    end select
  end subroutine add_work
end module inelastic_blocks
