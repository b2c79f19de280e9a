!> Keywords of Abaqus and CalculiX that are refused, each an error at its place in the deck that
!> says what to take instead.
module keywords_refused
  use keyword_handler, only: keyword_list
  use keyword_spec, only: find_spec, refused
  implicit none
  private
  public :: add_refused_keywords, is_refused_procedure

contains

  !> All refused keywords.
  subroutine add_refused_keywords(list)
    type(keyword_list), intent(inout) :: list
    call add_contact(list)
    call add_rigid_parts(list)
    call add_refused_procedures(list)
    call add_fields_and_loads(list)
    call add_materials(list)
    call add_meshers(list)
    call add_sections(list)
  end subroutine add_refused_keywords

  subroutine add_contact(list)
    type(keyword_list), intent(inout) :: list
    character(*), parameter :: pairs = '*CONTACT PAIR of each two surfaces'
    call add(list, 'CONTACT', 'General contact.', pairs)
    call add(list, 'CONTACT INCLUSIONS', 'Surfaces of general contact.', pairs)
    call add(list, 'CONTACT EXCLUSIONS', 'Surfaces of general contact.', pairs)
    call add(list, 'CONTACT PROPERTY ASSIGNMENT', 'Laws of general contact.', pairs)
    call add(list, 'CONTACT INTERFERENCE', 'Overlap that goes in a step.', &
             'the overlap in the mesh')
    call add(list, 'CONTACT DAMPING', 'Damping of contact.', '*DAMPING of a material or of the '// &
             'step')
    call add(list, 'CHANGE CONTACT TYPE', 'Kind of contact from a step on.', &
             'one kind of contact for all steps')
    call add(list, 'CHANGE FRICTION', 'Friction from a step on.', 'one *FRICTION for all steps')
    call add(list, 'CHANGE SURFACE BEHAVIOR', 'Normal law from a step on.', &
             'one *SURFACE BEHAVIOR for all steps')
    call add(list, 'GAP CONDUCTANCE', 'Heat across contact.', '*TEMPERATURE with temperatures '// &
             'from elsewhere')
  end subroutine add_contact

  subroutine add_rigid_parts(list)
    type(keyword_list), intent(inout) :: list
    character(*), parameter :: surface = '*DSLOAD or *DLOAD on the surface'
    call add(list, 'RIGID BODY', 'Makes a part rigid.', 'solids 1000 times as stiff, or *EQUATION')
    call add(list, 'COUPLING', 'Couples a surface to a node.', surface//', or *EQUATION')
    call add(list, 'KINEMATIC COUPLING', 'Couples nodes to a node.', '*EQUATION')
    call add(list, 'KINEMATIC', 'Couples a surface to a node.', '*EQUATION')
    call add(list, 'DISTRIBUTING COUPLING', 'Distributes the load of a node.', surface)
    call add(list, 'DISTRIBUTING', 'Distributes the load of a node.', surface)
    call add(list, 'EMBEDDED ELEMENT', 'Bars inside solids.', 'solids of a mean stiffness')
    call add(list, 'REBAR', 'Bars inside solids.', 'solids of a mean stiffness')
    call add(list, 'SPRING', 'Stiffness of springs.', '*JOINT LAW with KN and KT')
    call add(list, 'DASHPOT', 'Damping of dashpots.', '*DAMPING')
    call add(list, 'MASS', 'Mass of points.', 'solids with a *DENSITY')
    call add(list, 'NONSTRUCTURAL MASS', 'Mass beside that of the material.', &
             'a larger *DENSITY of the elements')
  end subroutine add_rigid_parts

  !> Procedures: a step with one of them has a procedure, though a refused one.
  subroutine add_refused_procedures(list)
    type(keyword_list), intent(inout) :: list
    character(*), parameter :: heat = '*TEMPERATURE with temperatures from elsewhere'
    character(*), parameter :: motion = '*DYNAMIC, REDUCED with a history of the motion'
    call add(list, 'VISCO', 'A static step with creep.', '*STATIC')
    call add(list, 'GEOSTATIC', 'Equilibrium of initial stresses.', '*STATIC with the weight')
    call add(list, 'ANNEAL', 'Takes stresses and plastic strains away.', '*MODEL CHANGE, '// &
             'REMOVE and ADD: elements that are added have no stress')
    call add(list, 'BUCKLE', 'Buckling.', '*STATIC with small strains')
    call add(list, 'HEAT TRANSFER', 'Temperatures by conduction.', heat)
    call add(list, 'COUPLED TEMPERATURE-DISPLACEMENT', 'Temperatures and stresses.', heat)
    call add(list, 'UNCOUPLED TEMPERATURE-DISPLACEMENT', 'Temperatures, then stresses.', heat)
    call add(list, 'SENSITIVITY', 'Sensitivities.', 'decks with changed values')
    call add(list, 'COMPLEX FREQUENCY', 'Modes with damping.', '*FREQUENCY: modes without damping')
    call add(list, 'MODAL DYNAMIC', 'Motion of modes.', motion)
    call add(list, 'STEADY STATE DYNAMICS', 'Harmonic motion.', motion)
    call add(list, 'RESPONSE SPECTRUM', 'Peaks of modes.', motion)
    call add(list, 'RANDOM RESPONSE', 'Motion by its spectrum.', motion)
  end subroutine add_refused_procedures

  !> Whether a keyword is a procedure that is refused.
  logical function is_refused_procedure(name)
    character(*), intent(in) :: name !< upper case
    integer, parameter :: most_procedures = 20
    type(keyword_list) :: list
    allocate (list%specs(most_procedures), list%entries(most_procedures))
    call add_refused_procedures(list)
    call list%trim()
    is_refused_procedure = find_spec(list%specs, name) > 0
  end function is_refused_procedure

  subroutine add_fields_and_loads(list)
    type(keyword_list), intent(inout) :: list
    character(*), parameter :: heat = '*TEMPERATURE with temperatures from elsewhere'
    call add(list, 'PARAMETER', 'Names for numbers of the deck.', 'numbers in place of the names')
    call add(list, 'DISTRIBUTION', 'Values by elements.', 'a set of elements for each value')
    call add(list, 'FIELD', 'Values that properties depend on.', 'a material for each value')
    call add(list, 'FILM', 'Heat by convection.', heat)
    call add(list, 'DFLUX', 'Sources of heat.', heat)
    call add(list, 'DESIGN VARIABLES', 'Sensitivities.', 'decks with changed values')
    call add(list, 'FOUNDATION', 'Springs below a face.', 'solids of rock below the face')
    call add(list, 'INERTIA RELIEF', 'Loads balanced by inertia.', '*BOUNDARY that holds the body')
    call add(list, 'IMPERFECTION', 'Moves the nodes by modes.', '*NODE with the coordinates moved')
    call add(list, 'SUBMODEL', 'Displacements of another model.', &
             '*BOUNDARY in a step with the displacements of the other model')
  end subroutine add_fields_and_loads

  subroutine add_materials(list)
    type(keyword_list), intent(inout) :: list
    character(*), parameter :: law = '*PLASTIC, *CONCRETE DAMAGED PLASTICITY or *USER MATERIAL'
    call add(list, 'MOHR COULOMB', 'Soil and rock that yield.', law)
    call add(list, 'MOHR COULOMB HARDENING', 'Cohesion of *MOHR COULOMB.', law)
    call add(list, 'DRUCKER PRAGER', 'Soil and rock that yield.', law)
    call add(list, 'DRUCKER PRAGER HARDENING', 'Strength of *DRUCKER PRAGER.', law)
    call add(list, 'CONCRETE', 'Smeared cracks.', law)
    call add(list, 'BRITTLE CRACKING', 'Smeared cracks.', law)
    call add(list, 'CREEP', 'Strains that grow in time.', '*USER MATERIAL')
    call add(list, 'VISCOELASTIC', 'Stiffness that relaxes in time.', '*ELASTIC with the '// &
             'sustained modulus, or *USER MATERIAL')
    call add(list, 'HYPERELASTIC', 'Rubber.', '*ELASTIC for small strains')
    call add(list, 'ORIENTATION', 'Axes of a material.', 'a deck without it: '// &
             'materials are the same in all directions')
  end subroutine add_materials

  !> Keywords that make nodes and elements, and axes of nodes.
  subroutine add_meshers(list)
    type(keyword_list), intent(inout) :: list
    character(*), parameter :: mesh = ' that a mesher or Abaqus/CAE writes in full'
    character(*), parameter :: node_makers(*) = [character(5) :: 'NGEN', 'NFILL', 'NCOPY', 'NMAP']
    character(*), parameter :: element_makers(*) = [character(6) :: 'ELGEN', 'ELCOPY']
    integer :: i
    do i = 1, size(node_makers)
      call add(list, trim(node_makers(i)), 'Makes nodes from others.', '*NODE'//mesh)
    end do
    do i = 1, size(element_makers)
      call add(list, trim(element_makers(i)), 'Makes elements from others.', '*ELEMENT'//mesh)
    end do
    call add(list, 'SYSTEM', 'Axes of the coordinates that follow.', '*NODE with coordinates '// &
             'along the axes of the model')
    call add(list, 'TRANSFORM', 'Axes of nodes.', 'forces in global components; for '// &
             'a support along an axis n, *EQUATION n1 u1 + n2 u2 + n3 u3 = 0')
  end subroutine add_meshers

  !> Sections of elements that there are not.
  subroutine add_sections(list)
    type(keyword_list), intent(inout) :: list
    character(*), parameter :: solids = '*SOLID SECTION of solids C3D8, C3D8B, C3D8I or C3D8R '// &
                               'in their place'
    call add(list, 'SHELL SECTION', 'Section of shells.', solids)
    call add(list, 'SHELL GENERAL SECTION', 'Section of shells.', solids)
    call add(list, 'MEMBRANE SECTION', 'Section of membranes.', solids)
    call add(list, 'BEAM SECTION', 'Section of beams.', solids)
    call add(list, 'BEAM GENERAL SECTION', 'Section of beams.', solids)
    call add(list, 'COHESIVE SECTION', 'Section of cohesive elements.', 'JOINT8 with the same '// &
             'nodes, and *JOINT')
    call add(list, 'CONNECTOR SECTION', 'Section of connectors.', '*JOINT, *TIE or *EQUATION')
    call add(list, 'GAP', 'Clearance of gap elements.', '*CONTACT PAIR or *JOINT on two surfaces')
    call add(list, 'PRE-TENSION SECTION', 'Prestress of bolts.', '*CLOAD at both anchors')
  end subroutine add_sections

  !> Adds a keyword without a handler.
  subroutine add(list, name, meaning, way_out)
    type(keyword_list), intent(inout) :: list
    character(*), intent(in) :: name, meaning, way_out
    list%num_keywords = list%num_keywords + 1
    associate (spec => list%specs(list%num_keywords))
      spec%name = name
      spec%family = 'other programs'
      spec%place = 'anywhere'
      spec%meaning = meaning//' Take instead: '//way_out//'.'
      spec%way_out = way_out
      spec%example = ''
      spec%status = refused
      allocate (spec%parameters(0), spec%columns(0))
    end associate
  end subroutine add
end module keywords_refused
