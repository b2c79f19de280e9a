!> Metal plasticity: the yield surface of von Mises with isotropic hardening by a table, integrated
!> by radial return (theory.md, 17; Simo and Hughes 1998, Computational Inelasticity, 3.3).
module material_metal
  use kinds, only: rk
  use material_elastic, only: elastic_law
  use material_law, only: stress_law
  use material_points, only: fracture_energy, no_tangent, point_set, point_state, stored_energy, &
                             secant_tangent, time_increment, update_report
  use tensor6, only: trace, von_mises
  use yield_curve, only: hardening_curve
  implicit none
  private
  public :: metal_law, make_metal_law

  !> Rows of the history: the plastic strain (engineering shear) and the equivalent plastic strain.
  integer, parameter :: plastic(6) = [1, 2, 3, 4, 5, 6], equivalent = 7

  type, extends(stress_law) :: metal_law
    type(elastic_law) :: elastic
    type(hardening_curve) :: curve
  contains
    procedure :: elastic_stiffness
    procedure :: update
    procedure :: read_field
  end type metal_law

  !> The flow of one point in an increment.
  type :: point_flow
    real(rk) :: growth = 0.0_rk !< of the equivalent plastic strain
    real(rk) :: slope = 0.0_rk !< of the yield stress at the end [Pa]
    real(rk) :: trial = 0.0_rk !< equivalent stress without the flow [Pa]
    real(rk) :: direction(6) = 0.0_rk !< 3/2 of the deviator over the equivalent stress
  end type point_flow

contains

  !> The law with its constants.
  type(metal_law) function make_metal_law(young, poisson, curve) result(law)
    real(rk), intent(in) :: young !< [Pa]
    real(rk), intent(in) :: poisson
    type(hardening_curve), intent(in) :: curve !< with slopes above -3 G
    law%num_state = equivalent
    law%is_nonlinear = .true.
    law%has_free_energy = .true.
    law%elastic = elastic_law(young=young, poisson=poisson)
    law%curve = curve
  end function make_metal_law

  pure subroutine elastic_stiffness(self, d)
    class(metal_law), intent(in) :: self
    real(rk), intent(out) :: d(6, 6)
    call self%elastic%elastic_stiffness(d)
  end subroutine elastic_stiffness

  !> Elastic predictor, radial return and tangent at each point.
  subroutine update(self, points, time, old, new, tangent, report)
    class(metal_law), intent(in) :: self
    type(point_set), intent(in) :: points
    type(time_increment), intent(in) :: time
    type(point_state), intent(in) :: old
    type(point_state), intent(inout) :: new
    real(rk), intent(inout) :: tangent(:, :, :)
    type(update_report), intent(out) :: report
    type(point_flow) :: flow
    real(rk) :: d(6, 6)
    integer :: p
    call self%elastic_stiffness(d)
    new%internal = old%internal
    new%energy = old%energy
    do p = 1, points%num_points
      new%stress(:, p) = matmul(d, new%strain(:, p) - old%internal(plastic, p))
      if (time%tangent /= no_tangent) tangent(:, :, p) = d
      call find_point_flow(self, new%stress(:, p), old%internal(equivalent, p), flow)
      if (flow%growth > 0.0_rk) then
        call add_flow(self, flow, new%stress(:, p), new%internal(:, p))
        if (time%tangent == secant_tangent) flow%slope = max(0.0_rk, flow%slope)
        if (time%tangent /= no_tangent) call take_loss(self, flow, tangent(:, :, p))
        new%energy(fracture_energy, p) = old%energy(fracture_energy, p) + &
                                         self%curve%work_between(old%internal(equivalent, p), &
                                                                 new%internal(equivalent, p))
      end if
      new%energy(stored_energy, p) = 0.5_rk*dot_product( &
                                     new%stress(:, p), new%strain(:, p) - new%internal(plastic, p))
      new%is_elastic(p) = .not. new%internal(equivalent, p) > 0.0_rk
    end do
    report%failed_point = 0
  end subroutine update

  !> The flow that brings a trial stress back to the yield surface; none within the surface.
  pure subroutine find_point_flow(law, trial, hardened, flow)
    class(metal_law), intent(in) :: law
    real(rk), intent(in) :: trial(6) !< stress without further flow [Pa]
    real(rk), intent(in) :: hardened !< equivalent plastic strain so far
    type(point_flow), intent(out) :: flow
    flow%trial = von_mises(trial)
    call law%curve%find_flow(hardened, flow%trial, 3.0_rk*shear_modulus(law), flow%growth, &
                             flow%slope)
    if (.not. flow%growth > 0.0_rk) return
    flow%direction = trial
    flow%direction(1:3) = trial(1:3) - trace(trial)/3.0_rk
    flow%direction = 1.5_rk*flow%direction/flow%trial
  end subroutine find_point_flow

  pure real(rk) function shear_modulus(law) result(shear)
    class(metal_law), intent(in) :: law
    shear = law%elastic%young/(2.0_rk*(1.0_rk + law%elastic%poisson))
  end function shear_modulus

  !> Stress and history after the flow.
  pure subroutine add_flow(law, flow, stress, internal)
    class(metal_law), intent(in) :: law
    type(point_flow), intent(in) :: flow
    real(rk), intent(inout) :: stress(6) !< [Pa]
    real(rk), intent(inout) :: internal(:) !< (7) history
    stress = stress - 2.0_rk*shear_modulus(law)*flow%growth*flow%direction
    internal(1:3) = internal(1:3) + flow%growth*flow%direction(1:3)
    internal(4:6) = internal(4:6) + 2.0_rk*flow%growth*flow%direction(4:6)
    internal(equivalent) = internal(equivalent) + flow%growth
  end subroutine add_flow

  !> Takes the loss of stiffness by the flow from the elastic stiffness (theory.md, (17.4)).
  pure subroutine take_loss(law, flow, tangent)
    class(metal_law), intent(in) :: law
    type(point_flow), intent(in) :: flow
    real(rk), intent(inout) :: tangent(6, 6) !< [Pa]
    real(rk) :: deviatoric(6, 6), shear, ratio
    integer :: i, j
    shear = shear_modulus(law)
    ratio = flow%growth/flow%trial
    deviatoric = 0.0_rk
    deviatoric(1:3, 1:3) = -1.0_rk/3.0_rk
    do i = 1, 3
      deviatoric(i, i) = 2.0_rk/3.0_rk
      deviatoric(i + 3, i + 3) = 0.5_rk
    end do
    do j = 1, 6
      do i = 1, 6
        tangent(i, j) = tangent(i, j) - 6.0_rk*shear**2*ratio*deviatoric(i, j) + &
                        4.0_rk*shear**2*(ratio - 1.0_rk/(3.0_rk*shear + flow%slope))* &
                        flow%direction(i)*flow%direction(j)
      end do
    end do
  end subroutine take_loss

  !> PE, PEEQ and SDV.
  subroutine read_field(self, name, state, values)
    class(metal_law), intent(in) :: self
    character(*), intent(in) :: name
    type(point_state), intent(in) :: state
    real(rk), allocatable, intent(out) :: values(:, :)
    select case (name)
    case ('PE')
      values = state%internal(plastic, :)
    case ('PEEQ')
      values = state%internal(equivalent:equivalent, :)
    case ('SDV')
      values = state%internal(:self%num_state, :)
    case default
      return
    end select
  end subroutine read_field
end module material_metal
