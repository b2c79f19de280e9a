!> Warnings of what the increments of a run show: energy that a scheme or a law creates, cracks that
!> jump, an accuracy that is not met.
submodule(run_records) run_warnings
  implicit none

  !> Energy that the time stepping may add in a dynamic step, over the largest energy of the
  !> balance. In docs/theory.md, 7.2, stable schemes add 2 %, others 100 %.
  real(rk), parameter :: largest_gain = 0.1_rk

  !> Energy that solids may dissipate in one static increment, over the largest energy of the
  !> balance. A crack in stable growth takes a few percent; a crack that snaps back takes most of
  !> the energy.
  real(rk), parameter :: largest_dissipation = 0.3_rk

  !> Nearer to the limit of ALPHA, -1/3, more damping of the scheme is no advice.
  real(rk), parameter :: strong_alpha = -0.25_rk

contains

  !> Warns of what an increment shows of the run.
  module subroutine warn_of_increment(self, model, now)
    class(run_record), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    if (self%damage%is_present) call check_law(self, model, now)
    if (model%steps(now%step)%procedure%has_inertia) call check_time_stepping(self, model, now)
    if (self%damage%is_present) call check_crack_energy(self, model, now)
    if (now%has_held_switches) then
      call warn_of_jump(self, 'step '//model%steps(now%step)%name, now%step_time)
    end if
    call check_size(self, model, now)
    call check_reduction(self, model, now)
    call check_sliding(self, model, now)
    call check_accuracy(self, model, now)
  end subroutine warn_of_increment

  !> Warns once in a step where equilibrium was found with the stiffness recovery fixed.
  subroutine warn_of_jump(self, step, time)
    class(run_record), intent(inout) :: self
    character(*), intent(in) :: step
    real(rk), intent(in) :: time !< of the step [s]
    character(:), allocatable :: words
    words = step//': the jump of RECOVERY=SIGN prevented equilibrium in an increment, first at '
    if (has_warned(self, words)) return
    call self%warn_once(words//as_text(time)//' s of the step; the stiffness recovery was '// &
                        'fixed at its value from the start of the increment')
  end subroutine warn_of_jump

  !> Warns when displacements exceed the size of the model: displacements are small here, so a part
  !> is loose or an input is wrong.
  subroutine check_size(self, model, now)
    class(run_record), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    associate (largest => self%displacement%at(1), plan => model%steps(now%step))
      if (.not. largest%is_found) return
      if (largest%value <= self%extent) return
      call self%warn_once('step '//plan%name//': a displacement is larger than '// &
                          'the model, and the program takes displacements as small: look for '// &
                          'parts that are not held, and for wrong units of loads or stiffness')
    end associate
  end subroutine check_size

  !> Warns when a reduced model does not meet the accuracy of its step, or when its estimate may be
  !> wrong. More modes help where it has as many as the deck names: a search has tried more, and a
  !> model with fewer has all there are. A bond that breaks an increment earlier or later changes
  !> what follows; two models that agree do not show that (theory.md, 7.4).
  subroutine check_reduction(self, model, now)
    class(run_record), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    character(:), allocatable :: advice
    associate (plan => model%steps(now%step), estimate => now%reduction%estimate)
      if (now%reduction%num_modes == 0) return
      if (count_broken(now%joints) > now%reduction%num_broken) then
        call self%warn_once('step '//plan%name//': bonds of joints break, and the error of the '// &
                            'reduced model may be larger than its estimate; compare with '// &
                            '*DYNAMIC without REDUCED')
      end if
      if (estimate <= plan%reduced%accuracy) return
      advice = 'take *DYNAMIC without REDUCED'
      if (now%reduction%num_modes == plan%reduced%num_modes) advice = advice//', or more MODES'
      call self%warn_once('step '//plan%name//': the reduced model does not reach the ACCURACY '// &
                          'of the step: the estimate is '//as_text(estimate)//'; '//advice)
    end associate
  end subroutine check_reduction

  !> Warns when points of joints slide or hit each other in a step that follows an accuracy: an
  !> error of a slip stays, an impact decides how a body goes on, and the estimate sees neither.
  subroutine check_sliding(self, model, now)
    class(run_record), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    associate (plan => model%steps(now%step))
      if (.not. plan%follows_accuracy()) return
      if (size(model%joints) > 0 .and. now%energy%shows_impacts()) then
        call self%warn_once('step '//plan%name//': impacts of joints take much of the energy '// &
                            '(numerical, in the energy balance), and ACCURACY does not bound '// &
                            'their error; take a smaller largest increment')
      end if
      if (.not. now%energy%shows_sliding()) return
      call self%warn_once('step '//plan%name//': points of joints slide, and ACCURACY does not '// &
                          'bound the error of their slips; compare with increments of half the '// &
                          'size')
    end associate
  end subroutine check_sliding

  !> Warns at the end of a step whose estimated error in time is above its ACCURACY. Where joints
  !> hit each other there is no such estimate.
  subroutine check_accuracy(self, model, now)
    class(run_record), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    associate (plan => model%steps(now%step), found => now%accuracy%relative())
      if (.not. plan%follows_accuracy() .or. found <= plan%controls%accuracy) return
      if (.not. now%is_last_of_step) return
      if (size(model%joints) > 0 .and. now%energy%shows_impacts()) return
      call self%warn_once('step '//plan%name//': *CONTROLS, ACCURACY is not met: the '// &
                          'estimated error in time is '//as_short_text(100.0_rk*found)// &
                          ' % of the largest displacement; name a smaller smallest increment')
    end associate
  end subroutine check_accuracy

  !> Warns when the recovery of stiffness of concrete drives the motion: no increment cures this.
  subroutine check_law(self, model, now)
    class(run_record), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    real(rk) :: gain
    gain = self%damage%created
    if (has_jumps(model)) gain = max(gain, -now%energy%numerical)
    if (gain <= largest_gain*now%energy%largest) return
    call self%warn_once('the law of concrete has created more than a tenth of the energy '// &
                        '("created" in job.json) where cracks close and open: its stress has '// &
                        'no potential, and smaller increments do not help; take RECOVERY=ENERGY')
  end subroutine check_law

  !> Warns when the time stepping drives the motion. The balance of energy does not show this error.
  !> What the laws of solids create is not its doing, nor is a stress that jumps: no increment is
  !> small enough for a jump.
  subroutine check_time_stepping(self, model, now)
    class(run_record), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    character(*), parameter :: added_energy = &
                               'the time stepping has added more than a tenth of the energy'
    character(:), allocatable :: advice
    real(rk) :: taken
    taken = now%energy%numerical + self%damage%created
    self%most_taken = max(self%most_taken, taken)
    if (self%most_taken - taken <= largest_gain*now%energy%largest) return
    if (has_jumps(model)) return
    advice = 'smaller increments'
    associate (plan => model%steps(now%step))
      if (plan%procedure%uses_alpha .and. plan%alpha > strong_alpha) then
        advice = advice//', or an ALPHA further below 0, down to -1/3'
      end if
    end associate
    if (abs(self%damage%created) > 0.0_rk) then
      advice = advice//', or concrete with RECOVERY=ENERGY, whose increments keep their energy'
    end if
    if (has_warned(self, added_energy)) return
    call self%warn_once(added_energy//' ("numerical" in the energy balance): do not trust this '// &
                        'motion; try '//advice)
  end subroutine check_time_stepping

  !> Whether a warning begins with these words.
  pure logical function has_warned(self, words)
    class(run_record), intent(in) :: self
    character(*), intent(in) :: words
    integer :: i
    has_warned = .false.
    do i = 1, size(self%warnings)
      has_warned = has_warned .or. index(self%warnings(i)%text, words) == 1
    end do
  end function has_warned

  !> Does the stress of a cracked material jump?
  logical function has_jumps(model)
    type(problem), intent(in) :: model
    integer :: i
    has_jumps = .false.
    do i = 1, size(model%materials)
      if (.not. allocated(model%materials(i)%law)) cycle
      has_jumps = has_jumps .or. model%materials(i)%law%has_switch
    end do
  end function has_jumps

  !> Warns when cracks dissipate much of the stored energy in one static increment: the structure
  !> has jumped from one equilibrium to another.
  subroutine check_crack_energy(self, model, now)
    class(run_record), intent(inout) :: self
    type(problem), intent(in) :: model
    type(state), intent(in) :: now
    real(rk) :: dissipated
    dissipated = min(self%last_strain - now%energy%strain, now%energy%fracture - self%last_fracture)
    self%last_strain = now%energy%strain
    self%last_fracture = now%energy%fracture
    if (.not. model%steps(now%step)%procedure%is_static()) return
    if (dissipated <= largest_dissipation*now%energy%largest) return
    call self%warn_once('cracks have dissipated much of the stored energy in one static '// &
                        'increment: the structure has jumped from one equilibrium to another; '// &
                        'take smaller increments, or a *DYNAMIC step if the jump remains')
  end subroutine check_crack_energy
end submodule run_warnings
