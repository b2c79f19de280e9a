!> The joints of one increment as a problem of their own, saved in a file: what the iteration on
!> jumps reads, without mesh and loads. tests/joint_problems solves the problems again.
!>
!> A file has one operator and one or more problems with it. With closed, sticking joints the jumps
!> are `closed_jump`; tractions t of the laws change them to
!>   v = closed_jump + G weight*area*(k_ref v - t).
!> All joints must have the contraction law.
module joint_problem
  use archive_type, only: archive
  use equilibrium, only: force_balance
  use errors, only: error_type, raise
  use hdf5_archive, only: hdf5_store
  use joint_contraction, only: contraction_law
  use joint_law, only: joint_state
  use joint_operator, only: jump_operator
  use joint_points, only: dam_joint
  use kinds, only: long, rk
  use step_plan, only: step_controls
  use write_text, only: as_text
  implicit none
  private
  public :: saved_operator, saved_problem, save_problem, load_operator, load_problem, free_path
  public :: triangle_size

  !> What several increments have in common.
  type :: saved_operator
    real(rk) :: weight = 1.0_rk !< of the joint forces in the balance
    real(rk), allocatable :: compliance(:, :) !< G (rows, rows) [m/N]
    type(jump_operator) :: operator !< places and areas of the points, no rows of B
    integer :: num_problems = 0
  end type saved_operator

  !> One increment.
  type :: saved_problem
    type(step_controls) :: controls
    type(dam_joint), allocatable :: joints(:) !< laws and numbers of points
    type(joint_state), allocatable :: old(:) !< converged histories
    type(force_balance) :: balance !< without loads
    real(rk), allocatable :: closed_jump(:, :) !< (3, points) [m]
  end type saved_problem

  integer, parameter :: most_files = 9999

contains

  !> Writes a file with one problem, if all joints have the contraction law.
  subroutine save_problem(path, common, problem, error)
    character(*), intent(in) :: path
    type(saved_operator), intent(in) :: common
    type(saved_problem), intent(in) :: problem
    type(error_type), allocatable, intent(out) :: error
    type(hdf5_store) :: file
    integer :: j
    do j = 1, size(problem%joints)
      if (.not. same_type_as(problem%joints(j)%law, contraction_law())) return
    end do
    if (triangle_size(size(common%compliance, 1)) > huge(1)) then
      call raise(error, 'the joints have '//as_text(size(common%compliance, 1))// &
                 ' rows: the file of a joint problem holds at most 65535')
      return
    end if
    call file%create(path)
    call file%open_group('operator')
    call save_operator(common, file)
    call file%close_group()
    call file%put('num_problems', 1)
    call file%open_group('problem_1')
    call save_increment(problem, file)
    call file%close_group()
    call file%close(error)
  end subroutine save_problem

  !> The first of STEM_joints_0001.h5, STEM_joints_0002.h5, .. that is no file; '' if all are.
  function free_path(stem) result(path)
    character(*), intent(in) :: stem
    character(:), allocatable :: path
    character(4) :: digits
    logical :: is_taken
    integer :: number
    do number = 1, most_files
      write (digits, '(i4.4)') number
      path = stem//'_joints_'//digits//'.h5'
      inquire (file=path, exist=is_taken)
      if (.not. is_taken) return
    end do
    path = ''
  end function free_path

  !> Entries of the lower triangle of a square matrix.
  pure integer(long) function triangle_size(rows)
    integer, intent(in) :: rows
    triangle_size = int(rows, long)*(rows + 1)/2
  end function triangle_size

  !> Writes G as its lower triangle, column by column.
  subroutine save_operator(common, file)
    type(saved_operator), intent(in) :: common
    class(archive), intent(inout) :: file
    real(rk), allocatable :: triangle(:)
    integer :: column, first, m
    m = size(common%compliance, 1)
    allocate (triangle(triangle_size(m)))
    first = 1
    do column = 1, m
      triangle(first:first + m - column) = common%compliance(column:, column)
      first = first + m - column + 1
    end do
    call file%put('weight', common%weight)
    call file%put('first_point', common%operator%first_point)
    call file%put('area', common%operator%area)
    call file%put('compliance', triangle)
  end subroutine save_operator

  !> Reads the operator of an open file.
  subroutine load_operator(file, common)
    class(archive), intent(inout) :: file
    type(saved_operator), intent(out) :: common
    real(rk), allocatable :: triangle(:)
    integer :: column, first, m
    call file%open_group('operator')
    call file%get('weight', common%weight)
    call file%get('first_point', common%operator%first_point)
    call file%get('area', common%operator%area)
    call file%get('compliance', triangle)
    call file%close_group()
    call file%get('num_problems', common%num_problems)
    if (file%has_failed()) return
    common%operator%num_points = size(common%operator%area)
    m = 3*common%operator%num_points
    allocate (common%compliance(m, m))
    first = 1
    do column = 1, m
      common%compliance(column:, column) = triangle(first:first + m - column)
      common%compliance(column, column:) = triangle(first:first + m - column)
      first = first + m - column + 1
    end do
  end subroutine load_operator

  !> Writes tolerances, start, laws and histories.
  subroutine save_increment(problem, file)
    type(saved_problem), intent(in) :: problem
    class(archive), intent(inout) :: file
    integer :: j
    call file%put('residual_tolerance', problem%controls%residual_tolerance)
    call file%put('increment_tolerance', problem%controls%increment_tolerance)
    call file%put('max_iterations', problem%controls%max_iterations)
    call file%put('guess', problem%balance%guess)
    call file%put('guess_traction', problem%balance%guess_traction)
    call file%put('starts_closed', problem%balance%starts_closed)
    call file%put('reference_force', problem%balance%reference_force)
    call file%put('is_static', problem%balance%is_static)
    call file%put('closed_jump', problem%closed_jump)
    do j = 1, size(problem%joints)
      call file%open_group('joint_'//as_text(j))
      call save_law(problem%joints(j), file)
      call problem%old(j)%save(file)
      call file%close_group()
    end do
  end subroutine save_increment

  !> Reads problem `number` of an open file.
  subroutine load_problem(file, number, common, problem)
    class(archive), intent(inout) :: file
    integer, intent(in) :: number
    type(saved_operator), intent(in) :: common
    type(saved_problem), intent(out) :: problem
    integer :: j, num_joints
    call file%open_group('problem_'//as_text(number))
    call file%get('residual_tolerance', problem%controls%residual_tolerance)
    call file%get('increment_tolerance', problem%controls%increment_tolerance)
    call file%get('max_iterations', problem%controls%max_iterations)
    call file%get('guess', problem%balance%guess)
    call file%get('guess_traction', problem%balance%guess_traction)
    call file%get('starts_closed', problem%balance%starts_closed)
    call file%get('reference_force', problem%balance%reference_force)
    call file%get('is_static', problem%balance%is_static)
    call file%get('closed_jump', problem%closed_jump)
    num_joints = size(common%operator%first_point) - 1
    allocate (problem%joints(num_joints), problem%old(num_joints))
    do j = 1, num_joints
      call file%open_group('joint_'//as_text(j))
      problem%joints(j)%num_points = common%operator%first_point(j + 1) &
                                     - common%operator%first_point(j)
      call load_law(problem%joints(j), file)
      call problem%old(j)%load(file)
      call file%close_group()
    end do
    call file%close_group()
  end subroutine load_problem

  !> Writes the constants of a contraction law.
  subroutine save_law(joint, file)
    type(dam_joint), intent(in) :: joint
    class(archive), intent(inout) :: file
    select type (law => joint%law)
    class is (contraction_law)
      call file%put('normal_stiffness', law%normal_stiffness)
      call file%put('tangent_stiffness', law%tangent_stiffness)
      call file%put('strength', law%strength)
      call file%put('friction', law%friction)
      call file%put('cohesion', law%cohesion)
      call file%put('penetration', law%penetration)
    end select
  end subroutine save_law

  !> Makes a contraction law from its constants.
  subroutine load_law(joint, file)
    type(dam_joint), intent(inout) :: joint
    class(archive), intent(inout) :: file
    type(contraction_law) :: law
    call file%get('normal_stiffness', law%normal_stiffness)
    call file%get('tangent_stiffness', law%tangent_stiffness)
    call file%get('strength', law%strength)
    call file%get('friction', law%friction)
    call file%get('cohesion', law%cohesion)
    call file%get('penetration', law%penetration)
    allocate (joint%law, source=law)
  end subroutine load_law
end module joint_problem
