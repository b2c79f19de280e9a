!> Makes the law of a user material after the whole deck is read. The UMAT returns the stiffness at
!> the start.
module finish_user_materials
  use diagnostics, only: diagnostic_list, place, severity_warning
  use element_hex8, only: hex8_gradients
  use errors, only: error_type
  use kinds, only: rk
  use material_points, only: consistent_tangent, point_set, time_increment
  use material_user, only: find_stiffness, make_user_law, user_constants, user_law
  use model_draft, only: draft, has_request, material_request, origin
  use write_text, only: as_text
  implicit none
  private
  public :: check_library, user_material

  !> An origin with card 0: the keyword is not given.
  type, extends(material_request) :: user_material
    type(user_constants) :: constants
    type(origin) :: spot, depvar
  contains
    procedure :: complete
  end type user_material

contains

  !> Reports a missing UMAT at the first user material. Warns of a UMAT without a user material.
  subroutine check_library(model, faults)
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(place) :: deck
    integer :: i
    do i = 1, size(model%material_requests)
      select type (given => model%material_requests(i)%item)
      type is (user_material)
        if (associated(model%problem%umat)) return
        if (given%spot%card == 0) cycle
        call model%cards(given%spot%card)%fault( &
          faults, 'no UMAT is given', 'the option --umat with its source or library: keyway '// &
          '--umat law.for job.inp')
        return
      end select
    end do
    if (.not. associated(model%problem%umat)) return
    deck%file = model%problem%deck_file ! a constructor of the type would take a wrong length
    deck%keyword = ''
    deck%source = ''
    call faults%add(severity_warning, deck, '--umat is given, but no material uses it', &
                    '*USER MATERIAL in a *MATERIAL')
  end subroutine check_library

  !> Warns of damping by the damaged stiffness, which a UMAT does not report.
  subroutine warn_of_damping(self, model, faults)
    class(user_material), intent(in) :: self
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    logical :: is_current
    associate (own => model%problem%materials(self%material))
      is_current = own%damps_current .and. own%beta > 0.0_rk
    end associate
    if (size(model%problem%steps) > 0) then
      is_current = is_current .or. any(model%problem%steps%damping%is_current)
    end if
    if (.not. is_current) return
    call model%cards(self%spot%card)%warn( &
      faults, '*DAMPING, BASE=CURRENT has no effect in this material: a UMAT does not report '// &
      'its damage; its initial stiffness damps', 'BASE=INITIAL')
  end subroutine warn_of_damping

  !> Makes the law with the stiffness that the UMAT returns at the start.
  subroutine complete(self, model, faults)
    class(user_material), intent(inout) :: self
    type(draft), intent(inout) :: model
    type(diagnostic_list), intent(inout) :: faults
    type(user_law) :: law
    type(point_set) :: points
    type(time_increment) :: time
    type(error_type), allocatable :: error
    call check_cards(self, model, faults)
    if (faults%has_errors()) return
    call warn_of_damping(self, model, faults)
    call make_user_law(model%problem%umat, self%constants, law)
    call first_point(model, self%material, points)
    time%tangent = consistent_tangent
    if (size(model%problem%steps) > 0) then
      if (model%problem%steps(1)%first_increment > 0.0_rk) then
        time%size = model%problem%steps(1)%first_increment
      end if
    end if
    call find_stiffness(law, points, time, error)
    if (allocated(error)) then
      call model%cards(self%spot%card)%fault(faults, error%message)
      return
    end if
    associate (now => model%problem%materials(self%material))
      allocate (now%law, source=law)
      now%remark = 'UMAT with '//as_text(size(law%constants%values))//' constants and '// &
                   as_text(law%constants%num_variables)//' state variables'
    end associate
  end subroutine complete

  !> Reports a missing *USER MATERIAL, and a second law.
  subroutine check_cards(self, model, faults)
    type(user_material), intent(in) :: self
    type(draft), intent(in) :: model
    type(diagnostic_list), intent(inout) :: faults
    if (self%spot%card == 0) then
      call model%cards(self%depvar%card)%fault( &
        faults, "material '"//self%constants%name//"' has no *USER MATERIAL", 'this keyword '// &
        'beside *DEPVAR')
      return
    end if
    associate (spot => model%cards(self%spot%card))
      if (allocated(model%problem%materials(self%material)%law)) then
        call spot%fault(faults, "material '"//self%constants%name//"' also has an *ELASTIC", &
                        'one law: the UMAT gives the elastic stiffness')
      else if (has_request(model, self%material)) then
        call spot%fault(faults, "material '"//self%constants%name//"' also has the keywords of "// &
                        'another law', 'one law')
      end if
    end associate
  end subroutine check_cards

  !> The centre of the first element of a material. Without elements it is the centre of a cube with
  !> the LENGTH of the first *MATERIAL TEST of the material.
  subroutine first_point(model, material, points)
    type(draft), intent(in) :: model
    integer, intent(in) :: material !< position
    type(point_set), intent(out) :: points
    real(rk) :: x(3, 8), gradient(3, 8, 8), weight(8)
    integer :: e, i, corner
    points%num_points = 1
    points%element = [1]
    points%number = [1]
    points%length = [1.0_rk]
    do i = size(model%problem%tests), 1, -1
      if (model%problem%tests(i)%material == material) points%length = model%problem%tests(i)%length
    end do
    allocate (points%x(3, 1), points%edges(3, 3, 1), source=0.0_rk)
    if (.not. allocated(model%problem%mesh%material_of_element)) return
    e = findloc(model%problem%mesh%material_of_element, material, dim=1)
    if (e == 0) return
    x = model%problem%mesh%x(:, model%problem%mesh%nodes(:, e))
    call hex8_gradients(x, gradient, weight, corner)
    points%element = model%problem%mesh%element_id(e)
    points%x(:, 1) = sum(x, 2)/8.0_rk
    if (corner == 0) points%length = sum(weight)**(1.0_rk/3.0_rk)
  end subroutine first_point
end module finish_user_materials
