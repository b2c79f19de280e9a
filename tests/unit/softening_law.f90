!> A law for tests of the procedures that use laws: isotropic damage, d = 1 - e0/e exp(-(e -
!> e0)/ef), where e is the largest value so far of sqrt(sum of squares of positive normal strains).
!> Its tangent is not symmetric, its energies are exact, and it can be told to fail.
module softening_law
  use kinds, only: rk
  use material_law, only: stress_law
  use material_elastic, only: elastic_law
  use material_points, only: point_set, point_state, time_increment, update_report, no_tangent, &
                             secant_tangent, stored_energy, fracture_energy
  use problem_definition, only: problem
  use inelastic_blocks, only: list_inelastic_blocks
  implicit none
  private
  public :: damage_law, put_law

  type, extends(stress_law) :: damage_law
    type(elastic_law) :: elastic
    real(rk) :: threshold = 1.0e-4_rk !< e0
    real(rk) :: slope = 1.0e-3_rk !< ef
    real(rk) :: largest_strain = huge(1.0_rk) !< more cannot be integrated
    real(rk) :: largest_change = huge(1.0_rk) !< of e in an increment; above it a cut is requested
  contains
    procedure :: elastic_stiffness, update, set_start
  end type damage_law

contains

  !> Gives some boxes of a model the law, and lists them.
  subroutine put_law(law, boxes, model)
    type(damage_law), intent(in) :: law
    integer, intent(in) :: boxes(:) !< materials
    type(problem), intent(inout) :: model
    type(damage_law) :: own
    integer :: i
    own = law
    own%is_nonlinear = .true.
    own%num_state = 1
    do i = 1, size(boxes)
      deallocate (model%materials(boxes(i))%law)
      allocate (model%materials(boxes(i))%law, source=own)
      model%materials(boxes(i))%name = 'SOFT'
    end do
    call list_inelastic_blocks(model%mesh, model%materials, model%inelastic)
  end subroutine put_law

  pure subroutine elastic_stiffness(self, d)
    class(damage_law), intent(in) :: self
    real(rk), intent(out) :: d(6, 6)
    call self%elastic%elastic_stiffness(d)
  end subroutine elastic_stiffness

  subroutine set_start(self, points, state)
    class(damage_law), intent(in) :: self
    type(point_set), intent(in) :: points
    type(point_state), intent(inout) :: state
    if (points%num_points > 0) state%internal(1, :) = self%threshold
  end subroutine set_start

  subroutine update(self, points, time, old, new, tangent, report)
    class(damage_law), intent(in) :: self
    type(point_set), intent(in) :: points
    type(time_increment), intent(in) :: time
    type(point_state), intent(in) :: old
    type(point_state), intent(inout) :: new
    real(rk), intent(inout) :: tangent(:, :, :)
    type(update_report), intent(out) :: report
    real(rk) :: d(6, 6), e, largest, stress(6), energy
    integer :: p, i
    call self%elastic%elastic_stiffness(d)
    do p = 1, points%num_points
      e = norm2(max(0.0_rk, new%strain(1:3, p)))
      if (e > self%largest_strain .and. report%failed_point == 0) then
        report%failed_point = p
        report%message = 'strained too far'
      end if
      associate (change => abs(e - norm2(max(0.0_rk, old%strain(1:3, p)))))
        if (change > self%largest_change) then
          report%size_ratio = min(report%size_ratio, self%largest_change/change)
        end if
      end associate
      largest = max(e, old%internal(1, p))
      new%internal(1, p) = largest
      stress = matmul(d, new%strain(:, p))
      energy = 0.5_rk*dot_product(stress, new%strain(:, p))
      new%is_elastic(p) = largest <= self%threshold
      new%stress(:, p) = kept(self, largest)*stress
      new%energy(stored_energy, p) = kept(self, largest)*energy
      ! Twice the mean of the undamaged energy times half the change of the damage.
      new%energy(fracture_energy, p) = old%energy(fracture_energy, p) &
                                       + 0.5_rk*(kept(self, old%internal(1, p)) &
                                                 - kept(self, largest)) &
                                       *(energy + 0.5_rk*dot_product(old%strain(:, p), &
                                                                     matmul(d, old%strain(:, p))))
      if (time%tangent == no_tangent) cycle
      tangent(:, :, p) = kept(self, largest)*d
      if (time%tangent == secant_tangent .or. e < largest .or. e <= self%threshold) cycle
      do i = 1, 3
        tangent(:, i, p) = tangent(:, i, p) &
                           + slope_of_kept(self, e)*max(0.0_rk, new%strain(i, p))/e*stress
      end do
    end do
  end subroutine update

  !> 1 - d.
  pure real(rk) function kept(self, e)
    type(damage_law), intent(in) :: self
    real(rk), intent(in) :: e
    kept = min(1.0_rk, self%threshold/e*exp(-(e - self%threshold)/self%slope))
  end function kept

  !> d (1 - d)/d e of a growing damage.
  pure real(rk) function slope_of_kept(self, e) result(slope)
    type(damage_law), intent(in) :: self
    real(rk), intent(in) :: e
    slope = -kept(self, e)*(1.0_rk/e + 1.0_rk/self%slope)
  end function slope_of_kept
end module softening_law
