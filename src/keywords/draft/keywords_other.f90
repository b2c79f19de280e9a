!> Keywords and parameters of other programs that are not available, each an error at its place in
!> the deck, or that have no effect here, each noted as ignored input.
module keywords_other
  use keyword_handler, only: keyword_list
  use keyword_spec, only: field, keyword, kind_text, later, refused, without_effect
  implicit none
  private
  public :: add_refused_keywords, add_ignored_keywords, add_idle_parameters

contains

  !> Keywords of Abaqus and CalculiX that are refused, with what to take instead.
  subroutine add_refused_keywords(list)
    type(keyword_list), intent(inout) :: list
    character(*), parameter :: pairs = '*CONTACT PAIR of each two surfaces'
    character(*), parameter :: stiff = 'solids 1000 times as stiff, or *EQUATION'
    call add_refused(list, 'CONTACT', 'General contact.', pairs)
    call add_refused(list, 'CONTACT INCLUSIONS', 'Surfaces of general contact.', pairs)
    call add_refused(list, 'CONTACT EXCLUSIONS', 'Surfaces of general contact.', pairs)
    call add_refused(list, 'CONTACT PROPERTY ASSIGNMENT', 'Laws of general contact.', pairs)
    call add_refused(list, 'CONTACT INTERFERENCE', 'Overlap that goes in a step.', &
                     'the overlap in the mesh')
    call add_refused(list, 'CHANGE FRICTION', 'Friction from a step on.', &
                     'one *FRICTION for all steps')
    call add_refused(list, 'CHANGE SURFACE BEHAVIOR', 'Normal law from a step on.', &
                     'one *SURFACE BEHAVIOR for all steps')
    call add_refused(list, 'RIGID BODY', 'Makes a part rigid.', stiff)
    call add_refused(list, 'COUPLING', 'Couples a surface to a node.', &
                     '*DSLOAD or *DLOAD on the surface, or *EQUATION')
    call add_refused(list, 'KINEMATIC COUPLING', 'Couples nodes to a node.', '*EQUATION')
    call add_refused(list, 'KINEMATIC', 'Couples a surface to a node.', '*EQUATION')
    call add_refused(list, 'DISTRIBUTING COUPLING', 'Distributes the load of a node.', &
                     '*DSLOAD or *DLOAD on the surface')
    call add_refused(list, 'DISTRIBUTING', 'Distributes the load of a node.', &
                     '*DSLOAD or *DLOAD on the surface')
    call add_refused(list, 'PARAMETER', 'Names for numbers of the deck.', &
                     'numbers in place of the names')
    call add_refused(list, 'TRANSFORM', 'Axes of nodes.', 'forces in global components; for '// &
                     'a support along an axis n, *EQUATION n1 u1 + n2 u2 + n3 u3 = 0')
    call add_refused(list, 'ORIENTATION', 'Axes of a material.', 'a deck without it: '// &
                     'materials are the same in all directions')
    call add_refused_procedures(list)
    call add_refused_materials(list)
  end subroutine add_refused_keywords

  !> Procedures of other programs.
  subroutine add_refused_procedures(list)
    type(keyword_list), intent(inout) :: list
    character(*), parameter :: heat = '*TEMPERATURE with temperatures from elsewhere'
    character(*), parameter :: motion = '*DYNAMIC, REDUCED with a history of the motion'
    call add_refused(list, 'VISCO', 'A static step with creep.', '*STATIC')
    call add_refused(list, 'GEOSTATIC', 'Equilibrium of initial stresses.', &
                     '*STATIC with the weight')
    call add_refused(list, 'BUCKLE', 'Buckling.', '*STATIC with small strains')
    call add_refused(list, 'HEAT TRANSFER', 'Temperatures by conduction.', heat)
    call add_refused(list, 'COUPLED TEMPERATURE-DISPLACEMENT', 'Temperatures and stresses.', heat)
    call add_refused(list, 'UNCOUPLED TEMPERATURE-DISPLACEMENT', 'Temperatures, then stresses.', &
                     heat)
    call add_refused(list, 'GAP CONDUCTANCE', 'Heat across contact.', heat)
    call add_refused(list, 'DESIGN VARIABLES', 'Sensitivities.', 'decks with changed values')
    call add_refused(list, 'SENSITIVITY', 'Sensitivities.', 'decks with changed values')
    call add_refused(list, 'CHANGE CONTACT TYPE', 'Kind of contact from a step on.', &
                     'one kind of contact for all steps')
    call add_refused(list, 'MODAL DYNAMIC', 'Motion of modes.', motion)
    call add_refused(list, 'STEADY STATE DYNAMICS', 'Harmonic motion.', motion)
    call add_refused(list, 'RESPONSE SPECTRUM', 'Peaks of modes.', motion)
    call add_refused(list, 'RANDOM RESPONSE', 'Motion by its spectrum.', motion)
  end subroutine add_refused_procedures

  !> Materials of other programs, and elements inside others.
  subroutine add_refused_materials(list)
    type(keyword_list), intent(inout) :: list
    character(*), parameter :: law = '*PLASTIC, *CONCRETE DAMAGED PLASTICITY or *USER MATERIAL'
    character(*), parameter :: bars = 'solids of a mean stiffness'
    call add_refused(list, 'MOHR COULOMB', 'Soil and rock that yield.', law)
    call add_refused(list, 'MOHR COULOMB HARDENING', 'Cohesion of *MOHR COULOMB.', law)
    call add_refused(list, 'DRUCKER PRAGER', 'Soil and rock that yield.', law)
    call add_refused(list, 'DRUCKER PRAGER HARDENING', 'Strength of *DRUCKER PRAGER.', law)
    call add_refused(list, 'CONCRETE', 'Smeared cracks.', law)
    call add_refused(list, 'BRITTLE CRACKING', 'Smeared cracks.', law)
    call add_refused(list, 'CREEP', 'Strains that grow in time.', '*USER MATERIAL')
    call add_refused(list, 'HYPERELASTIC', 'Rubber.', '*ELASTIC for small strains')
    call add_refused(list, 'EMBEDDED ELEMENT', 'Bars inside solids.', bars)
    call add_refused(list, 'REBAR', 'Bars inside solids.', bars)
    call add_refused(list, 'SPRING', 'Stiffness of springs.', '*JOINT LAW with KN and KT')
    call add_refused(list, 'DASHPOT', 'Damping of dashpots.', '*DAMPING')
    call add_refused(list, 'MASS', 'Mass of points.', 'solids with a *DENSITY')
  end subroutine add_refused_materials

  subroutine add_refused(list, name, meaning, way_out)
    type(keyword_list), intent(inout) :: list
    character(*), intent(in) :: name, meaning, way_out
    call add_later(list, name, 'other programs', 'anywhere', &
                   meaning//' Take instead: '//way_out//'.')
    list%specs(list%num_keywords)%status = refused
    list%specs(list%num_keywords)%way_out = way_out
  end subroutine add_refused

  !> Adds a keyword without a handler.
  subroutine add_later(list, name, family, place, meaning)
    type(keyword_list), intent(inout) :: list
    character(*), intent(in) :: name, family, place, meaning
    list%num_keywords = list%num_keywords + 1
    associate (spec => list%specs(list%num_keywords))
      spec%name = name
      spec%family = family
      spec%place = place
      spec%meaning = meaning
      spec%example = ''
      spec%status = later
      allocate (spec%parameters(0), spec%columns(0))
    end associate
  end subroutine add_later

  !> Cards that ask Abaqus or CalculiX for output.
  subroutine add_ignored_keywords(list)
    type(keyword_list), intent(inout) :: list
    call add_ignored(list, 'CONTACT OUTPUT', 'Contact results. Joints: *JOINT PRINT, OPENING.')
    call add_ignored(list, 'CONTACT CONTROLS', 'Controls of the iteration of contact.')
    call add_ignored(list, 'CONTACT FILE', 'Contact results. Joints: *JOINT PRINT, OPENING.')
    call add_ignored(list, 'CONTACT PRINT', 'Contact results. Joints: *JOINT PRINT, OPENING.')
    call add_ignored(list, 'ENERGY OUTPUT', 'Energies. They are always in job_energy.csv.')
    call add_ignored(list, 'ENERGY PRINT', 'Energies. They are always in job_energy.csv.')
    call add_ignored(list, 'ENERGY FILE', 'Energies. They are always in job_energy.csv.')
    call add_ignored(list, 'SECTION PRINT', 'Forces of a section.')
    call add_ignored(list, 'SECTION FILE', 'Forces of a section.')
    call add_ignored(list, 'INCREMENTATION OUTPUT', 'Data of increments. They are in job.log.')
    call add_ignored(list, 'MODAL OUTPUT', 'Data of modes. They are in job.json.')
    call add_ignored(list, 'MODAL FILE', 'Data of modes. They are in job.json.')
    call add_ignored(list, 'SECTION CONTROLS', 'Hourglass control of Abaqus; C3D8R has its own.')
    call add_ignored(list, 'MONITOR', 'Watches one degree of freedom.')
    call add_ignored(list, 'PRINT', 'Chooses what Abaqus prints while it runs.')
    call add_ignored(list, 'FILE FORMAT', 'Format of the results file of Abaqus.')
    call add_ignored(list, 'TIME POINTS', 'Times of output.')
    call add_ignored(list, 'CONDUCTIVITY', 'Property of conduction.')
    call add_ignored(list, 'SPECIFIC HEAT', 'Property of conduction.')
    call add_ignored(list, 'FILE OUTPUT', 'Opens requests for the results file of Abaqus.')
    call add_ignored(list, 'SURFACE OUTPUT', 'Results of surfaces.')
    call add_ignored(list, 'INTEGRATED OUTPUT', 'Forces of a section.')
    call add_ignored(list, 'INTEGRATED OUTPUT SECTION', 'The section of *INTEGRATED OUTPUT.')
    call add_ignored(list, 'RADIATION OUTPUT', 'Results of radiation.')
    call add_ignored(list, 'DIAGNOSTICS', 'Messages of Abaqus.')
    call add_ignored(list, 'PHYSICAL CONSTANTS', 'Constants of radiation and gravitation.')
  end subroutine add_ignored_keywords

  !> Adds a keyword without effect.
  subroutine add_ignored(list, name, meaning)
    type(keyword_list), intent(inout) :: list
    character(*), intent(in) :: name, meaning
    list%num_keywords = list%num_keywords + 1
    associate (spec => list%specs(list%num_keywords))
      spec%name = name
      spec%family = 'other programs'
      spec%place = 'anywhere'
      spec%meaning = meaning
      spec%example = ''
      spec%status = without_effect
      allocate (spec%parameters(0), spec%columns(0))
    end associate
  end subroutine add_ignored

  !> Adds parameters of other programs that are noted as ignored input.
  subroutine add_idle_parameters(spec, names)
    type(keyword), intent(inout) :: spec
    character(*), intent(in) :: names(:)
    type(field), allocatable :: longer(:)
    integer :: i, n
    n = 0
    if (allocated(spec%parameters)) n = size(spec%parameters)
    allocate (longer(n + size(names)))
    do i = 1, n
      longer(i) = spec%parameters(i)
    end do
    do i = 1, size(names)
      longer(n + i)%name = trim(names(i))
      longer(n + i)%kind = kind_text
      longer(n + i)%meaning = 'has no effect here'
      longer(n + i)%has_no_effect = .true.
    end do
    call move_alloc(longer, spec%parameters)
  end subroutine add_idle_parameters
end module keywords_other
