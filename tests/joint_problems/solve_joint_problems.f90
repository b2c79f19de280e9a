!> Solves saved problems of joints and writes one line for each:
!> file, problem, points, converged, loose, iterations, sweeps, passes, seconds,
!> residual.
!>
!> usage: solve_joint_problems METHOD FILE ..
!> METHOD is `policy`, the iteration of the program, or one of its parts alone: `newton` (100 full
!> steps), `sweeps` (1000), `passes` (fixed point of Tresca).
!> The residual is that of the laws at the jumps found: the difference between these jumps and those
!> that the structure takes under the tractions of the laws, times the stiffness of the structure at
!> each point alone, over the tractions.
program solve_joint_problems
  use errors, only: error_type
  use hdf5_archive, only: hdf5_store
  use block_compliance, only: take_blocks
  use contact_scaling, only: find_contact_scale
  use joint_operator, only: joint_springs
  use point_groups, only: group_list, single_group
  use joint_forces, only: joint_field, reference_stiffness
  use joint_iteration, only: joint_increment, smallest_force, start_iteration
  use joint_law, only: joint_state
  use joint_policy, only: run_passes, run_sweeps, share_of
  use joint_problem, only: load_operator, load_problem, saved_operator, saved_problem
  use kinds, only: rk
  use newton_condensed, only: condensed_joints, iterate_on_jumps, open_response, start_policy
  implicit none

  integer, parameter :: newton_steps = 50, all_sweeps = 1000, sweeps_at_once = 50
  integer :: i

  do i = 2, command_argument_count()
    call solve_file(argument(1), argument(i))
  end do

contains

  !> Solves all problems of a file.
  subroutine solve_file(method, path)
    character(*), intent(in) :: method, path
    type(hdf5_store) :: file
    type(saved_operator) :: common
    type(saved_problem) :: problem
    type(condensed_joints) :: condensed
    type(error_type), allocatable :: error
    integer :: number
    call file%open(path)
    call load_operator(file, common)
    do number = 1, common%num_problems
      call load_problem(file, number, common, problem)
      if (file%has_failed()) exit
      call condense(common, problem, condensed)
      call solve_one(method, path, number, common, problem, condensed)
    end do
    call file%close(error)
    if (.not. allocated(error)) return
    write (*, '(a)') error%message
    error stop 1
  end subroutine solve_file

  !> The operator of the iteration for the stiffness of the laws of one problem.
  subroutine condense(common, problem, condensed)
    type(saved_operator), intent(in) :: common
    type(saved_problem), intent(in) :: problem
    type(condensed_joints), intent(out) :: condensed
    type(group_list) :: all_points
    condensed%weight = common%weight
    call reference_stiffness(problem%joints, common%operator, condensed%k_ref)
    call single_group(common%operator%num_points, all_points)
    call take_blocks(common%compliance, &
                     joint_springs(common%operator, condensed%k_ref, common%weight), all_points, &
                     0.0_rk, condensed%blocks)
    call find_contact_scale(condensed%blocks, common%operator, condensed%k_ref, common%weight, &
                            condensed%scale, condensed%opened)
  end subroutine condense

  !> Solves one problem and writes its line.
  subroutine solve_one(method, path, number, common, problem, condensed)
    character(*), intent(in) :: method, path
    integer, intent(in) :: number
    type(saved_operator), intent(in), target :: common
    type(saved_problem), intent(inout), target :: problem
    type(condensed_joints), intent(inout), target :: condensed
    type(joint_state), allocatable, target :: new(:)
    type(joint_increment) :: now
    real(rk) :: started, ended, residual
    character(:), allocatable :: name
    new = problem%old
    call cpu_time(started)
    call now%view(problem%controls, problem%joints, common%operator, condensed%k_ref, &
                  problem%old, new)
    call start_iteration(problem%balance, condensed%scale, now)
    now%field%response = open_response(condensed, common%operator%area, problem%closed_jump, &
                                       now%field)
    call run_method(method, common, problem, condensed, now)
    call cpu_time(ended)
    residual = measure_laws(common, problem, condensed, now%field)
    name = path(index(path, '/', back=.true.) + 1:)
    associate (outcome => now%outcome)
      write (*, '(a,",",i0,",",i0,2(",",l1),3(",",i0),",",es9.2,",",es9.2)') name, number, &
        common%operator%num_points, outcome%has_converged, outcome%is_loose, outcome%iterations, &
        outcome%sweeps, outcome%passes, ended - started, residual
    end associate
  end subroutine solve_one

  !> The policy of the program, or one of its parts.
  subroutine run_method(method, common, problem, condensed, now)
    character(*), intent(in) :: method
    type(saved_operator), intent(in) :: common
    type(saved_problem), intent(inout), target :: problem
    type(condensed_joints), intent(inout) :: condensed
    type(joint_increment), intent(inout) :: now
    select case (method)
    case ('policy')
      call iterate_on_jumps(condensed, now)
    case ('newton')
      problem%controls%max_iterations = newton_steps
      call start_policy(condensed, now%operator, now%field)
      call condensed%run_newton(now)
    case ('passes')
      call start_policy(condensed, now%operator, now%field)
      call condensed%find_closed(now%operator)
      now%field%scale = condensed%scale
      call run_passes(condensed, now)
    case ('sweeps')
      call start_policy(condensed, now%operator, now%field)
      call condensed%find_closed(now%operator)
      now%field%scale = condensed%scale
      do while (now%outcome%sweeps < all_sweeps .and. .not. now%outcome%has_converged)
        call run_sweeps(condensed, sweeps_at_once, now)
        now%outcome%has_converged = measure_laws(common, problem, condensed, now%field) &
                                    < problem%controls%residual_tolerance
      end do
    case default
      error stop 'unknown method'
    end select
  end subroutine run_method

  !> The residual of the laws at the jumps of a field.
  real(rk) function measure_laws(common, problem, condensed, field) result(residual)
    type(saved_operator), intent(in) :: common
    type(saved_problem), intent(in) :: problem
    type(condensed_joints), intent(in) :: condensed
    type(joint_field), intent(in) :: field
    type(joint_field) :: exact
    associate (operator => common%operator, share => share_of(condensed%weight, common%operator))
      exact = field
      exact%iterate = field%traction
      exact%response = open_response(condensed, operator%area, problem%closed_jump, exact)
      associate (wrong => share*(exact%response - exact%jump), own => condensed%scale%own)
        residual = hypot(norm2(own(1, :)*wrong(1, :)), norm2(own([2, 2], :)*wrong(2:3, :))) &
                   /max(norm2(share*field%traction), condensed%weight*smallest_force(field))
      end associate
    end associate
  end function measure_laws

  !> An argument of the program.
  function argument(number) result(text)
    integer, intent(in) :: number
    character(:), allocatable :: text
    integer :: length
    call get_command_argument(number, length=length)
    allocate (character(length) :: text)
    call get_command_argument(number, text)
  end function argument
end program solve_joint_problems
