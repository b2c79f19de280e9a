!> Worked example of a material law: plasticity of von Mises with linear isotropic hardening,
!> integrated by radial return (Simo and Hughes 1998, Computational Inelasticity, box 3.2).
module material_von_mises
  use kinds, only: rk
  use material_elastic, only: elastic_law
  use material_law, only: stress_law
  use material_points, only: fracture_energy, no_tangent, point_set, point_state, stored_energy, &
                             time_increment, update_report
  use tensor6, only: trace, von_mises
  implicit none
  private
  public :: von_mises_law, make_von_mises

  !> Rows of the history: the plastic strain (engineering shear) and the equivalent plastic strain.
  integer, parameter :: plastic(6) = [1, 2, 3, 4, 5, 6], equivalent = 7

  type, extends(stress_law) :: von_mises_law
    type(elastic_law) :: elastic
    real(rk) :: yield = 0.0_rk !< first yield stress in tension [Pa]
    real(rk) :: hardening = 0.0_rk !< of the yield stress over the equivalent plastic strain [Pa]
  contains
    procedure :: elastic_stiffness
    procedure :: update
    procedure :: read_field
  end type von_mises_law

contains

  !> The law with its elastic constants.
  type(von_mises_law) function make_von_mises(young, poisson, yield, hardening) result(law)
    real(rk), intent(in) :: young, yield, hardening !< [Pa]
    real(rk), intent(in) :: poisson
    law%num_state = equivalent
    law%is_nonlinear = .true.
    law%elastic = elastic_law(young=young, poisson=poisson)
    law%yield = yield
    law%hardening = hardening
  end function make_von_mises

  pure subroutine elastic_stiffness(self, d)
    class(von_mises_law), intent(in) :: self
    real(rk), intent(out) :: d(6, 6)
    call self%elastic%elastic_stiffness(d)
  end subroutine elastic_stiffness

  !> Elastic predictor, radial return and consistent tangent at each point.
  subroutine update(self, points, time, old, new, tangent, report)
    class(von_mises_law), intent(in) :: self
    type(point_set), intent(in) :: points
    type(time_increment), intent(in) :: time
    type(point_state), intent(in) :: old
    type(point_state), intent(inout) :: new
    real(rk), intent(inout) :: tangent(:, :, :)
    type(update_report), intent(out) :: report
    real(rk) :: d(6, 6), growth, mean
    integer :: i
    call self%elastic_stiffness(d)
    new%internal = old%internal
    new%energy = old%energy
    do i = 1, points%num_points
      new%stress(:, i) = matmul(d, new%strain(:, i) - old%internal(plastic, i))
      if (time%tangent /= no_tangent) tangent(:, :, i) = d
      growth = growth_of(self, new%stress(:, i), old%internal(equivalent, i))
      if (growth > 0.0_rk) then
        if (time%tangent /= no_tangent) then
          call soften(self, new%stress(:, i), growth, tangent(:, :, i))
        end if
        call return_to_surface(self, growth, new%stress(:, i), new%internal(:, i))
        mean = 0.5_rk*(old%internal(equivalent, i) + new%internal(equivalent, i))
        new%energy(fracture_energy, i) = old%energy(fracture_energy, i) + &
                                         growth*(self%yield + self%hardening*mean)
      end if
      new%energy(stored_energy, i) = 0.5_rk*dot_product( &
                                     new%stress(:, i), new%strain(:, i) - new%internal(plastic, i))
      new%is_elastic(i) = .not. new%internal(equivalent, i) > 0.0_rk
    end do
    report%failed_point = 0
  end subroutine update

  !> Increment of the equivalent plastic strain, not positive within the yield surface.
  pure real(rk) function growth_of(law, trial, hardened) result(growth)
    class(von_mises_law), intent(in) :: law
    real(rk), intent(in) :: trial(6) !< stress without further yielding [Pa]
    real(rk), intent(in) :: hardened !< equivalent plastic strain so far
    growth = (von_mises(trial) - law%yield - law%hardening*hardened)/ &
             (3.0_rk*shear_modulus(law) + law%hardening)
  end function growth_of

  pure real(rk) function shear_modulus(law) result(shear)
    class(von_mises_law), intent(in) :: law
    shear = law%elastic%young/(2.0_rk*(1.0_rk + law%elastic%poisson))
  end function shear_modulus

  !> Direction of the flow: 3/2 of the deviator over the equivalent stress.
  pure function flow_direction(stress) result(flow)
    real(rk), intent(in) :: stress(6) !< [Pa]
    real(rk) :: flow(6) !< components of the tensor
    flow = stress
    flow(1:3) = flow(1:3) - trace(stress)/3.0_rk
    flow = 1.5_rk*flow/von_mises(stress)
  end function flow_direction

  !> Moves the stress back to the yield surface and notes the plastic strain.
  pure subroutine return_to_surface(law, growth, stress, internal)
    class(von_mises_law), intent(in) :: law
    real(rk), intent(in) :: growth
    real(rk), intent(inout) :: stress(6) !< [Pa]
    real(rk), intent(inout) :: internal(:) !< (7) history
    real(rk) :: flow(6)
    flow = flow_direction(stress)
    stress = stress - 2.0_rk*shear_modulus(law)*growth*flow
    internal(1:3) = internal(1:3) + growth*flow(1:3)
    internal(4:6) = internal(4:6) + 2.0_rk*growth*flow(4:6)
    internal(equivalent) = internal(equivalent) + growth
  end subroutine return_to_surface

  !> Takes the loss of stiffness by yielding from the elastic stiffness.
  pure subroutine soften(law, trial, growth, tangent)
    class(von_mises_law), intent(in) :: law
    real(rk), intent(in) :: trial(6), growth
    real(rk), intent(inout) :: tangent(6, 6) !< [Pa]
    real(rk) :: deviatoric(6, 6), flow(6), shear, q
    integer :: i, j
    shear = shear_modulus(law)
    q = von_mises(trial)
    flow = flow_direction(trial)
    deviatoric = 0.0_rk
    deviatoric(1:3, 1:3) = -1.0_rk/3.0_rk
    do i = 1, 3
      deviatoric(i, i) = 2.0_rk/3.0_rk
      deviatoric(i + 3, i + 3) = 0.5_rk
    end do
    do j = 1, 6
      do i = 1, 6
        tangent(i, j) = tangent(i, j) - 6.0_rk*shear**2*growth/q*deviatoric(i, j) + &
                        4.0_rk*shear**2*(growth/q - 1.0_rk/(3.0_rk*shear + law%hardening))* &
                        flow(i)*flow(j)
      end do
    end do
  end subroutine soften

  !> PE and SDV.
  subroutine read_field(self, name, state, values)
    class(von_mises_law), intent(in) :: self
    character(*), intent(in) :: name
    type(point_state), intent(in) :: state
    real(rk), allocatable, intent(out) :: values(:, :)
    if (name == 'PE') values = state%internal(plastic, :)
    if (name == 'SDV') values = state%internal(:self%num_state, :)
  end subroutine read_field
end module material_von_mises
