!> A material whose law is a UMAT of the user, called point by point.
module material_user
  use, intrinsic :: iso_c_binding, only: c_associated, c_int, c_loc
  use errors, only: deck_is_wrong, error_type, raise
  use kinds, only: rk
  use material_law, only: start_points, stress_law
  use material_points, only: crushing_energy, fracture_energy, no_tangent, point_set, &
                             point_state, secant_tangent, stored_energy, time_increment, &
                             update_report
  use small_matrix, only: solve_dense
  use umat_findings, only: call_place, tangent_check
  use umat_guards, only: fault_of_call, guarded_state, has_cholesky_factor, largest_asymmetry, &
                         size_of_guard
  use umat_interface, only: keyway_umat_call, keyway_umat_disable_traps, &
                            keyway_umat_restore_folder, keyway_umat_restore_traps, &
                            keyway_umat_start, failure_reason, &
                            umat_arguments
  use umat_loader, only: user_library
  use umat_tangent, only: compare_tangent, num_probes, strain_probes
  use write_text, only: as_text
  implicit none
  private
  public :: user_law, user_constants, make_user_law, find_stiffness

  integer, parameter :: num_energies_kept = 3 !< SSE, SPD, SCD behind the state variables
  !> PNEWDT before a call; a request is a value below 1.
  real(rk), parameter :: no_request = 1.0e10_rk
  real(rk), parameter :: round_off = 1.0e-10_rk !< asymmetry of DDSDDE, over its largest entry
  real(rk), parameter :: unit_matrix(3, 3) = reshape([1.0_rk, 0.0_rk, 0.0_rk, 0.0_rk, 1.0_rk, &
                                                      0.0_rk, 0.0_rk, 0.0_rk, 1.0_rk], [3, 3])

  !> Constants of one material from the deck.
  type :: user_constants
    character(:), allocatable :: name !< upper case
    real(rk), allocatable :: values(:) !< PROPS
    integer :: num_variables = 0 !< NSTATV
    logical :: is_unsymmetric = .false. !< DDSDDE is not symmetrised
  end type user_constants

  type, extends(stress_law) :: user_law
    type(user_library), pointer :: library => null() !< loaded code: one for all materials
    type(user_constants) :: constants
    real(rk) :: stiffness(6, 6) = 0.0_rk !< at the start of the analysis, symmetric [Pa]
    real(rk) :: compliance(6, 6) = 0.0_rk !< its inverse [1/Pa]
  contains
    procedure :: elastic_stiffness
    procedure :: update
    procedure :: set_start
    procedure :: read_field
  end type user_law

contains

  !> Makes a law without stiffness; `find_stiffness` must follow.
  subroutine make_user_law(library, constants, law)
    type(user_library), pointer, intent(in) :: library
    type(user_constants), intent(in) :: constants
    type(user_law), intent(out) :: law
    law%library => library
    law%constants = constants
    law%num_state = constants%num_variables + num_energies_kept
    law%is_nonlinear = .true.
    law%is_serial = .not. library%is_threadsafe
    law%wants_gradient = .true.
    law%may_be_tried = .false.
  end subroutine make_user_law

  !> Initial stiffness, from a call without strain at the first point.
  subroutine find_stiffness(law, points, time, error)
    type(user_law), intent(inout) :: law
    type(point_set), intent(in) :: points
    type(time_increment), intent(in) :: time !< of the first increment
    type(error_type), allocatable, intent(out) :: error
    type(point_state) :: old, new
    type(update_report) :: report
    real(rk) :: tangent(6, 6, points%num_points), identity(6, 6)
    logical :: is_singular
    integer :: i
    call start_points(law, points, old)
    new = old
    call law%update(points, time, old, new, tangent, report)
    ! A request for a smaller increment says nothing of the stiffness.
    if (report%failed_point > 0 .and. .not. report%size_ratio < 1.0_rk) then
      call raise(error, 'call without strain at element '//as_text(points%element(1))//': '// &
                 report%message, deck_is_wrong)
      return
    end if
    law%stiffness = 0.5_rk*(tangent(:, :, 1) + transpose(tangent(:, :, 1)))
    if (.not. has_cholesky_factor(law%stiffness)) then
      call raise(error, 'DDSDDE of the UMAT without strain is not positive definite for '// &
                 'material '//law%constants%name//' (diagonal: '// &
                 diagonal_text(law%stiffness)//'): there is no initial stiffness', &
                 deck_is_wrong)
      return
    end if
    identity = 0.0_rk
    do i = 1, 6
      identity(i, i) = 1.0_rk
    end do
    call solve_dense(law%stiffness, identity, law%compliance, is_singular)
  end subroutine find_stiffness

  pure function diagonal_text(matrix) result(text)
    real(rk), intent(in) :: matrix(6, 6)
    character(:), allocatable :: text
    integer :: i
    text = as_text(matrix(1, 1))
    do i = 2, 6
      text = text//', '//as_text(matrix(i, i))
    end do
  end function diagonal_text

  !> Stiffness by `find_stiffness`.
  pure subroutine elastic_stiffness(self, d)
    class(user_law), intent(in) :: self
    real(rk), intent(out) :: d(6, 6)
    d = self%stiffness
  end subroutine elastic_stiffness

  !> Calls the UMAT at each point. A point fails if the routine stops, returns NaN or writes past
  !> its state variables. If it requests a smaller increment all points are called, and the smallest
  !> request counts.
  subroutine update(self, points, time, old, new, tangent, report)
    class(user_law), intent(in) :: self
    type(point_set), intent(in) :: points
    type(time_increment), intent(in) :: time
    type(point_state), intent(in) :: old
    type(point_state), intent(inout) :: new
    real(rk), intent(inout) :: tangent(:, :, :)
    type(update_report), intent(out) :: report
    type(umat_arguments) :: now
    type(guarded_state) :: variables, constants
    character(:), allocatable :: fault
    integer :: p
    call keyway_umat_disable_traps()
    do p = 1, points%num_points
      call prepare_call(self, points, p, time, old, new, now)
      call call_point(self, old%internal(:, p), now, variables, constants, fault)
      if (len(fault) > 0) then
        report%failed_point = p
        report%size_ratio = 1.0_rk
        report%message = 'UMAT: '//fault
        exit
      end if
      if (now%pnewdt < report%size_ratio) then
        report%failed_point = p
        report%size_ratio = now%pnewdt
        report%message = 'the UMAT requests a smaller increment (PNEWDT = '// &
                         as_text(now%pnewdt)//')'
      end if
      call store_answer(self, p, now, variables, old, new)
      if (self%library%checks_tangent) then
        call check_tangent(self, place_of(self, points, p, time), old%stress(:, p), &
                           old%internal(:, p), now)
      end if
      if (time%tangent /= no_tangent) then
        call set_tangent(self, place_of(self, points, p, time), time%tangent, now%ddsdde, &
                         tangent(:, :, p))
      end if
    end do
    call keyway_umat_restore_traps()
    if (keyway_umat_restore_folder() == 0 .or. report%failed_point > 0) return
    report%failed_point = 1
    report%size_ratio = 1.0_rk
    report%message = 'UMAT: the routine changes the working folder'
  end subroutine update

  pure type(call_place) function place_of(self, points, p, time) result(place)
    class(user_law), intent(in) :: self
    type(point_set), intent(in) :: points
    integer, intent(in) :: p
    type(time_increment), intent(in) :: time
    place%material = self%constants%name
    place%element = points%element(p)
    place%point = points%number(p)
    place%step = time%step
    place%increment = time%increment
  end function place_of

  !> Arguments of a call except state variables and constants. Strains are small: DFGRD is I + grad
  !> u, DROT the unit matrix.
  pure subroutine prepare_call(self, points, p, time, old, new, now)
    class(user_law), intent(in) :: self
    type(point_set), intent(in) :: points
    integer, intent(in) :: p
    type(time_increment), intent(in) :: time
    type(point_state), intent(in) :: old, new
    type(umat_arguments), intent(out) :: now
    now%stress = old%stress(:, p)
    now%stran = old%strain(:, p)
    now%dstran = new%strain(:, p) - old%strain(:, p)
    now%time = [time%step_time, time%total_time]
    now%dtime = time%size
    now%dfgrd0 = unit_matrix + old%gradient(:, :, p)
    now%dfgrd1 = unit_matrix + new%gradient(:, :, p)
    if (allocated(old%temperature)) then
      now%temp = old%temperature(p)
      now%dtemp = new%temperature(p) - old%temperature(p)
    end if
    now%kstep(1) = int(time%step, c_int)
    now%kinc = int(time%increment, c_int)
    now%pnewdt = no_request
    call set_place(self, points, p, now)
  end subroutine prepare_call

  !> Sets number and place of a point.
  pure subroutine set_place(self, points, p, now)
    class(user_law), intent(in) :: self
    type(point_set), intent(in) :: points
    integer, intent(in) :: p
    type(umat_arguments), intent(inout) :: now
    integer :: i
    now%coords = points%x(:, p)
    now%celent = points%length(p)
    now%noel = int(points%element(p), c_int)
    now%npt = int(points%number(p), c_int)
    now%nstatv = int(self%constants%num_variables, c_int)
    now%nprops = int(size(self%constants%values), c_int)
    do i = 1, min(size(now%cmname), len(self%constants%name))
      now%cmname(i) = self%constants%name(i:i)
    end do
  end subroutine set_place

  !> One guarded call, from the converged history in each iteration.
  subroutine call_point(self, history, now, variables, constants, fault)
    class(user_law), intent(in) :: self
    real(rk), intent(in) :: history(:) !< of the point: state variables, SSE, SPD, SCD
    type(umat_arguments), intent(inout) :: now
    type(guarded_state), intent(inout), target :: variables, constants
    character(:), allocatable, intent(out) :: fault !< '' for a valid result
    integer :: n
    n = self%constants%num_variables
    call constants%fill(self%constants%values)
    call variables%fill(history(:n))
    now%sse = history(n + 1)
    now%spd = history(n + 2)
    now%scd = history(n + 3)
    now%statev = c_loc(variables%room(size_of_guard + 1))
    now%props = c_loc(constants%room(size_of_guard + 1))
    if (allocated(self%library%found%bad_start)) then
      fault = self%library%found%bad_start
    else if (keyway_umat_call(self%library%umat, now) /= 0) then
      fault = failure_reason()
    else
      fault = fault_of_call(now, variables)
      if (len(fault) == 0 .and. .not. constants%is_intact()) then
        fault = 'the routine writes outside of its '//as_text(size(self%constants%values))// &
                ' constants (PROPS)'
      end if
    end if
    variables%is_marked = len(fault) == 0
    constants%is_marked = len(fault) == 0
  end subroutine call_point

  !> Stores stress, history and energies of a valid result. If the UMAT leaves SSE at zero, the
  !> stored energy is the elastic energy of the undamaged stiffness, and the rest of the work is
  !> dissipated.
  pure subroutine store_answer(self, p, now, variables, old, new)
    class(user_law), intent(in) :: self
    integer, intent(in) :: p
    type(umat_arguments), intent(in) :: now
    type(guarded_state), intent(in) :: variables
    type(point_state), intent(in) :: old
    type(point_state), intent(inout) :: new
    real(rk) :: work
    integer :: n
    n = self%constants%num_variables
    new%internal(:n, p) = variables%values()
    new%internal(n + 1:, p) = [now%sse, now%spd, now%scd]
    new%is_elastic(p) = .false.
    new%stress(:, p) = now%stress
    new%energy(crushing_energy, p) = 0.0_rk
    if (abs(now%sse) > 0.0_rk) then
      new%energy(stored_energy, p) = now%sse
      new%energy(fracture_energy, p) = now%spd + now%scd
    else
      work = sum(old%energy(:, p)) + 0.5_rk*dot_product(old%stress(:, p) + now%stress, now%dstran)
      new%energy(stored_energy, p) = 0.5_rk*dot_product(now%stress, &
                                                        matmul(self%compliance, now%stress))
      new%energy(fracture_energy, p) = work - new%energy(stored_energy, p)
    end if
  end subroutine store_answer

  !> Sets the requested tangent: DDSDDE, symmetrised unless the deck has UNSYMM. A secant is always
  !> symmetric, and is the initial stiffness where DDSDDE is not positive definite.
  subroutine set_tangent(self, place, kind, ddsdde, tangent)
    class(user_law), intent(in) :: self
    type(call_place), intent(in) :: place
    integer, intent(in) :: kind
    real(rk), intent(in) :: ddsdde(6, 6)
    real(rk), intent(out) :: tangent(6, 6)
    real(rk) :: share
    tangent = ddsdde
    if (.not. self%constants%is_unsymmetric .or. kind == secant_tangent) then
      tangent = 0.5_rk*(ddsdde + transpose(ddsdde))
    end if
    if (.not. self%constants%is_unsymmetric) then
      share = largest_asymmetry(ddsdde)
      if (share > round_off) call self%library%found%add_asymmetry(place, share)
    end if
    if (kind /= secant_tangent) return
    if (.not. has_cholesky_factor(tangent)) tangent = self%stiffness
  end subroutine set_tangent

  !> Compares DDSDDE with differences of STRESS around the strain of a call.
  subroutine check_tangent(self, place, start, history, answer)
    class(user_law), intent(in) :: self
    type(call_place), intent(in) :: place
    real(rk), intent(in) :: start(6), history(:) !< stress and history before the increment
    type(umat_arguments), intent(in) :: answer
    type(umat_arguments) :: now
    type(guarded_state) :: variables, constants
    type(tangent_check) :: check
    character(:), allocatable :: fault
    real(rk) :: dstran(6, num_probes), stress(6, num_probes)
    logical :: is_sound(num_probes)
    integer :: i
    dstran = strain_probes(answer)
    do i = 1, num_probes
      now = answer
      now%stress = start
      now%dstran = dstran(:, i)
      now%ddsdde = 0.0_rk
      now%pnewdt = no_request
      call call_point(self, history, now, variables, constants, fault)
      is_sound(i) = len(fault) == 0
      stress(:, i) = now%stress
    end do
    call compare_tangent(answer, place, stress, is_sound, check)
    call self%library%found%add_check(check)
  end subroutine check_tangent

  !> Initial state variables: zero, or by SDVINI.
  subroutine set_start(self, points, state)
    class(user_law), intent(in) :: self
    type(point_set), intent(in) :: points
    type(point_state), intent(inout) :: state
    type(umat_arguments) :: now
    type(guarded_state), target :: variables
    character(:), allocatable :: fault
    logical :: has_moved
    integer :: p, n
    state%internal = 0.0_rk
    state%is_elastic = .false.
    if (.not. c_associated(self%library%sdvini)) return
    n = self%constants%num_variables
    call keyway_umat_disable_traps()
    do p = 1, points%num_points
      call set_place(self, points, p, now)
      call variables%fill(state%internal(:n, p))
      now%statev = c_loc(variables%room(size_of_guard + 1))
      if (keyway_umat_start(self%library%sdvini, now) /= 0) then
        fault = failure_reason()
      else
        fault = variables%fault()
      end if
      has_moved = keyway_umat_restore_folder() /= 0
      if (len(fault) == 0 .and. has_moved) then
        fault = 'the routine changes the working folder'
      end if
      if (len(fault) > 0) then
        self%library%found%bad_start = 'SDVINI at element '//as_text(points%element(p))// &
                                       ', point '//as_text(points%number(p))//': '//fault
        exit
      end if
      state%internal(:n, p) = variables%values()
    end do
    call keyway_umat_restore_traps()
  end subroutine set_start

  !> 'SDV': all state variables.
  subroutine read_field(self, name, state, values)
    class(user_law), intent(in) :: self
    character(*), intent(in) :: name
    type(point_state), intent(in) :: state
    real(rk), allocatable, intent(out) :: values(:, :)
    if (name /= 'SDV' .or. self%constants%num_variables == 0) return
    values = state%internal(:self%constants%num_variables, :)
  end subroutine read_field
end module material_user
