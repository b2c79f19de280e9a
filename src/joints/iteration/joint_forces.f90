!> The laws of all joints at once: tractions and tangents of all points of the operator.
module joint_forces
  use kinds, only: rk
  use joint_law, only: joint_state, phase_absent, state_open
  use joint_points, only: dam_joint
  use joint_operator, only: jump_operator
  use contact_augmentation, only: contact_multiplier
  use contact_scaling, only: contact_scale
  implicit none
  private
  public :: joint_field, start_joints, reference_stiffness
  public :: evaluate_joints, gather_tractions, gather_jumps, gather_gaps, linear_tractions
  public :: take_origins, size_of_origins

  !> Friction with given limits in place of that of the laws.
  type :: tresca_limits
    real(rk), allocatable :: bound(:) !< (points) limit; not allocated: the laws decide [Pa]
    real(rk), allocatable :: friction(:) !< (points) mu
    real(rk), allocatable :: cohesion(:) !< (points) c [Pa]
    real(rk), allocatable :: slip(:, :) !< (2, points) converged [m]
    logical, allocatable :: is_bonded(:) !< (points)
  end type tresca_limits

  !> Jumps, tractions and tangents of all points of all joints in one row.
  type :: joint_field
    real(rk), allocatable :: gap(:) !< (points) at the start, with the shift of the contact [m]
    type(contact_multiplier) :: contact
    real(rk), allocatable :: jump(:, :) !< (3, points) where the laws were evaluated [m]
    real(rk), allocatable :: multiplier(:, :) !< (3, points) of the last iterate [Pa]
    type(contact_scale) :: scale !< r of the augmented form
    real(rk), allocatable :: traction(:, :) !< (3, points) of the laws [Pa]
    real(rk), allocatable :: iterate(:, :) !< (3, points) of the augmented form [Pa]
    real(rk), allocatable :: tangent(:, :, :) !< (3, 3, points) [Pa/m]
    logical, allocatable :: is_open(:) !< (points) in the last linearisation: no stiffness
    logical, allocatable :: was_open(:) !< (points) at the previous linearisation
    integer, allocatable :: num_openings(:) !< (points) transitions to open in this increment
    real(rk), allocatable :: response(:, :) !< (3, points) jumps of the linearised equilibrium [m]
    !> Force of the jumps that blocks of G cause which are left out, over the joint forces
    real(rk) :: drift = 0.0_rk
    real(rk), allocatable :: start_jump(:, :) !< (3, points) of the last converged state [m]
    real(rk), allocatable :: start_spring(:, :) !< (3, points) traction there over k_ref [m]
    !> 2-norm of the jumps that grout has made the zero of the laws: their round-off stays [m]
    real(rk) :: origin_size = 0.0_rk
    real(rk) :: start_force = 0.0_rk !< 2-norm of area*traction in the last converged state [N]
    real(rk) :: bulk_force = 0.0_rk !< reference force of the bulk [N]
    logical :: is_static = .false. !< no inertia in the equilibrium
    type(tresca_limits) :: tresca
  end type joint_field

contains

  !> Initial histories of joints.
  subroutine start_joints(joints, states)
    type(dam_joint), intent(in) :: joints(:)
    type(joint_state), allocatable, intent(out) :: states(:)
    integer :: j
    allocate (states(size(joints)))
    do j = 1, size(joints)
      call joints(j)%law%start_state(joints(j)%clearance, states(j))
    end do
  end subroutine start_joints

  !> Stiffness of the closed, sticking joint at every point.
  subroutine reference_stiffness(joints, operator, stiffness)
    type(dam_joint), intent(in) :: joints(:)
    type(jump_operator), intent(in) :: operator
    real(rk), allocatable, intent(out) :: stiffness(:, :) !< (3, points) [Pa/m]
    real(rk) :: k(3)
    integer :: j, p
    allocate (stiffness(3, operator%num_points))
    do j = 1, size(joints)
      call joints(j)%law%reference_stiffness(k)
      do p = operator%first_point(j), operator%first_point(j + 1) - 1
        stiffness(:, p) = k
      end do
    end do
  end subroutine reference_stiffness

  !> Evaluates all laws at `field%jump` with `field%multiplier` and `field%scale`.
  subroutine evaluate_joints(joints, operator, old, field, new)
    type(dam_joint), intent(in) :: joints(:)
    type(jump_operator), intent(in) :: operator
    type(joint_state), intent(in) :: old(:) !< converged histories
    type(joint_field), intent(inout) :: field
    type(joint_state), intent(inout) :: new(:) !< trial histories
    integer :: j, first, last
    do j = 1, size(joints)
      first = operator%first_point(j)
      last = operator%first_point(j + 1) - 1
      associate (jump => field%jump(:, first:last), multiplier => field%multiplier(:, first:last))
        new(j)%num_openings = field%num_openings(first:last)
        call joints(j)%law%linearise(jump, old(j), multiplier, field%scale%own(:, first:last), &
                                     new(j), field%iterate(:, first:last), &
                                     field%tangent(:, :, first:last))
        if (allocated(old(j)%phase)) then
          call silence_absent(old(j), new(j), field%iterate(:, first:last), &
                              field%tangent(:, :, first:last))
        end if
      end associate
    end do
    field%is_open = .not. any(any(abs(field%tangent) > 0.0_rk, 1), 1)
    call gather_tractions(operator, new, field%traction)
  end subroutine evaluate_joints

  !> Points behind which an element is absent carry nothing and do not change.
  pure subroutine silence_absent(old, new, iterate, tangent)
    type(joint_state), intent(in) :: old !< converged history
    type(joint_state), intent(inout) :: new !< trial history
    real(rk), intent(inout) :: iterate(:, :) !< (3, points) [Pa]
    real(rk), intent(inout) :: tangent(:, :, :) !< (3, 3, points) [Pa/m]
    integer :: p
    do p = 1, size(old%phase)
      if (old%phase(p) /= phase_absent) cycle
      iterate(:, p) = 0.0_rk
      tangent(:, :, p) = 0.0_rk
      new%jump(:, p) = 0.0_rk
      new%traction(:, p) = 0.0_rk
      new%slip(:, p) = 0.0_rk
      new%internal(:, p) = old%internal(:, p)
      new%is_broken(p) = old%is_broken(p)
      new%friction_work(p) = old%friction_work(p)
      new%fracture_work(p) = old%fracture_work(p)
      new%status(p) = state_open
    end do
  end subroutine silence_absent

  !> Relative displacements of the nodes where those of the laws are zero, taken from those of the
  !> nodes; nothing in models without stages.
  subroutine take_origins(operator, states, jump)
    type(jump_operator), intent(in) :: operator
    type(joint_state), intent(in) :: states(:)
    real(rk), intent(inout) :: jump(:, :) !< (3, points) [m]
    integer :: j
    do j = 1, size(states)
      if (.not. allocated(states(j)%origin)) cycle
      associate (own => jump(:, operator%first_point(j):operator%first_point(j + 1) - 1))
        own = own - states(j)%origin
      end associate
    end do
  end subroutine take_origins

  !> 2-norm of the relative displacements where those of the laws are zero; 0 without stages [m].
  pure real(rk) function size_of_origins(states) result(size_of_all)
    type(joint_state), intent(in) :: states(:)
    integer :: j
    size_of_all = 0.0_rk
    do j = 1, size(states)
      if (allocated(states(j)%origin)) size_of_all = norm2([size_of_all, norm2(states(j)%origin)])
    end do
  end function size_of_origins

  !> Tractions of the laws at all points.
  subroutine gather_tractions(operator, states, traction)
    type(jump_operator), intent(in) :: operator
    type(joint_state), intent(in) :: states(:)
    real(rk), intent(out) :: traction(:, :) !< (3, points) [Pa]
    integer :: j
    do j = 1, size(states)
      traction(:, operator%first_point(j):operator%first_point(j + 1) - 1) = states(j)%traction
    end do
  end subroutine gather_tractions

  !> Gaps of all points, with the shifts of the contact augmentation.
  subroutine gather_gaps(operator, states, gap)
    type(jump_operator), intent(in) :: operator
    type(joint_state), intent(in) :: states(:)
    real(rk), allocatable, intent(out) :: gap(:) !< (points) [m]
    integer :: j
    allocate (gap(operator%num_points))
    do j = 1, size(states)
      gap(operator%first_point(j):operator%first_point(j + 1) - 1) = states(j)%gap &
                                                                     + states(j)%shift
    end do
  end subroutine gather_gaps

  !> Jumps of all points.
  subroutine gather_jumps(operator, states, jump)
    type(jump_operator), intent(in) :: operator
    type(joint_state), intent(in) :: states(:)
    real(rk), intent(out) :: jump(:, :) !< (3, points) [m]
    integer :: j
    do j = 1, size(states)
      jump(:, operator%first_point(j):operator%first_point(j + 1) - 1) = states(j)%jump
    end do
  end subroutine gather_jumps

  !> Tractions of the linearised equilibrium: iterate + tangent*correction.
  pure subroutine linear_tractions(field, correction, traction)
    type(joint_field), intent(in) :: field
    real(rk), intent(in) :: correction(:, :) !< (3, points) of the jumps [m]
    real(rk), intent(out) :: traction(:, :) !< (3, points) [Pa]
    integer :: p
    do p = 1, size(correction, 2)
      traction(:, p) = field%iterate(:, p) + matmul(field%tangent(:, :, p), correction(:, p))
    end do
  end subroutine linear_tractions
end module joint_forces
