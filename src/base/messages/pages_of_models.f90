!> Pages on messages: the model that a deck describes.
module pages_of_models
  use message_pages, only: page_list
  implicit none
  private
  public :: add_pages_of_models

contains

  !> Adds all pages of this module, in the order in which their signs are looked for.
  subroutine add_pages_of_models(list)
    type(page_list), intent(inout) :: list
    call pages_from_kept_supports(list)
    call pages_from_no_effect(list)
    call pages_from_light_solids(list)
    call pages_from_replaced_weight(list)
    call pages_from_loose_block(list)
    call pages_from_plastic_table(list)
    call pages_from_inner_face(list)
    call pages_from_faces_apart(list)
    call pages_from_acts_twice(list)
  end subroutine add_pages_of_models

  subroutine pages_from_kept_supports(list)
    type(page_list), intent(inout) :: list
    call list%add('supports-of-modes', &
                  'supports of this *FREQUENCY step stay', &
                  '*BOUNDARY in a *FREQUENCY step changes the supports of this step and of all '// &
                  'steps after it, as in CalculiX. In Abaqus such a step is a perturbation, '// &
                  'whose supports end with it.', &
                  'Give all supports again with OP=NEW in the next *STATIC or *DYNAMIC step, '// &
                  'or find the frequencies in a deck of their own.', &
                  '*BOUNDARY; CREST, 1 in the *FREQUENCY step', &
                  '*BOUNDARY, OP=NEW; BASE, 1, 3 in the step after it')
    call list%add('other-loads-stay', &
                  'clears the loads of this keyword alone', &
                  'OP=NEW of *DLOAD clears the loads of *DLOAD, that of *DSLOAD those of '// &
                  '*DSLOAD, as in Abaqus. CalculiX clears both. The message names pressures: a '// &
                  'weight is usually meant to stay.', &
                  'Give OP=NEW with both keywords where all pressures end, and the weight '// &
                  'again.', &
                  '*DLOAD, OP=NEW where a *DSLOAD of an earlier step must end too', &
                  '*DLOAD, OP=NEW and *DSLOAD, OP=NEW')
    call list%add('support-on-tie', &
                  'not tied in direction', &
                  'A tie makes slave nodes follow the master surface, the same nodes in all '// &
                  'steps. A node that a support of some steps holds does not follow in this '// &
                  'direction: it is free of the tie in the other steps too, and the surfaces '// &
                  'can part there.', &
                  'Exchange slave and master, so that the support holds nodes of the master; '// &
                  'or let the support act in all steps.', &
                  'a slave node held from step 2 on', &
                  'the surface with the held nodes as master')
  end subroutine pages_from_kept_supports

  subroutine pages_from_light_solids(list)
    type(page_list), intent(inout) :: list
    call list%add('light-solid', &
                  'times that of the heaviest solid: sudden', &
                  'A solid with next to no mass has periods far below any increment. Smooth '// &
                  'loads move it as a solid without mass. Where a load comes at once, a '// &
                  'support with a reaction goes, or a dynamic step follows one with REDUCED, '// &
                  'a small force gives the small mass a large acceleration, and the '// &
                  'increments do not follow it.', &
                  'Leave *DENSITY out: a solid without density follows its forces in static '// &
                  'balance.', &
                  '*MATERIAL, NAME=ROCK; *DENSITY; 1e-6', &
                  '*MATERIAL, NAME=ROCK; *ELASTIC; 2e10, 0.2')
    call list%add('massless-damping', &
                  'massless solids one damping', &
                  'A reduced model has one response for all solids without mass, with one '// &
                  'damping over the stiffness. Materials without density that have another '// &
                  'BETA are described wrongly: displacements of a block on two such layers '// &
                  'were 72 % off with an estimate of 0.07 %.', &
                  'Give massless materials one BETA, or take *DYNAMIC without REDUCED.', &
                  '*DAMPING, BETA=0.004 of massless rock below an undamped layer', &
                  '*DAMPING, BETA=0.004 of both')
    call list%add('coupled-damping', &
                  'couples its modes', &
                  'The damping couples the modes of a reduced model with the response beyond '// &
                  'them where solids with mass have several BETA. This coupling is left out: '// &
                  'openings of two blocks with BETA of 0.004, 0.0005 and 0.002 were up to '// &
                  '10 % off with an estimate of 1.5 %, whatever the number of modes.', &
                  'Give all materials with mass one BETA (ALPHA may differ), or take *DYNAMIC '// &
                  'without REDUCED.', &
                  '*DAMPING, BETA=0.004 of the rock and BETA=0.001 of the dam', &
                  '*DAMPING, BETA=0.004 of both')
  end subroutine pages_from_light_solids

  subroutine pages_from_replaced_weight(list)
    type(page_list), intent(inout) :: list
    call list%add('replaced-weight', &
                  'of an earlier step ends', &
                  'GRAV of a set replaces the GRAV that an earlier step gave to the same set, '// &
                  'also where its direction is another one. The earlier weight does not act '// &
                  'any more. CalculiX adds the two.', &
                  'Give both lines in this step if both are meant.', &
                  'DAM, GRAV, 2., 1., 0., 0.', &
                  'DAM, GRAV, 9.81, 0., 0., -1. and DAM, GRAV, 2., 1., 0., 0.')
    call list%add('nothing-left', &
                  'no solid is left', &
                  '*MODEL CHANGE, REMOVE has taken away all solids of the model. The step has '// &
                  'nothing to analyse.', &
                  'Remove the parts that are built later alone, or add a part in this step.')
  end subroutine pages_from_replaced_weight

  subroutine pages_from_no_effect(list)
    type(page_list), intent(inout) :: list
    call list%add('no-effect', &
                  'not held in all directions|has no effect|have no effect|nothing uses|'// &
                  'not written|sets the initial '// &
                  'velocities|belongs to no element|has no field|'// &
                  'fields stay zero|sliding is small|strains and rotations are '// &
                  'small|there is no V|held in direction|do not meet', &
                  'The program understands what the deck says, and it changes nothing: a '// &
                  'parameter without a meaning here, a card that nothing uses, a field that '// &
                  'the model does not have.', &
                  'Remove it, or look for the reason why it has no effect: often a name, a '// &
                  'step or a set is not the one that was meant.', &
                  '*AMPLITUDE that no load names', &
                  'AMPLITUDE=NAME in the load')
    call list%add('growing-set', &
                  'gets members here that', &
                  'A card takes the nodes or elements of a set as they stand above it. Members '// &
                  'that the set gets further down do not belong to it. Abaqus takes the whole '// &
                  'set.', &
                  'Complete a set before its first use, or give the later members another set.')
    call list%add('parts-share-numbers', &
                  'instances share numbers', &
                  'Instances of an assembly use the same numbers for nodes and elements. In '// &
                  'the results numbers must be unique, so an offset is added.', &
                  'Nothing needs to be done. The offsets of all instances are in job.json '// &
                  'under instances.')
    call list%add('meaning-of-c3d8', &
                  'C3D8 is the element of Abaqus|C3D8 has full integration|the deck was '// &
                  'written for Abaqus|in a deck with parts', &
                  'C3D8 of Abaqus is a B-bar element, C3D8 of CalculiX has full integration. '// &
                  'Keyway follows CalculiX; in a deck from Abaqus the element that was meant '// &
                  'is C3D8B.', &
                  'Write TYPE=C3D8B, or choose for the whole deck with --c3d8=bbar or '// &
                  '--c3d8=full, which also ends the warning.', &
                  '*ELEMENT, TYPE=C3D8', &
                  '*ELEMENT, TYPE=C3D8B')
    call list%add('different-supports', &
                  'different accelerations|have this acceleration|too, without this '// &
                  'acceleration|moves, but no support|has the acceleration of an earlier', &
                  'Accelerations of supports describe the motion of the base, which is one '// &
                  'motion for each direction.', &
                  'Give all supports of a direction the same acceleration, or use *BASE '// &
                  'MOTION. Supports that move differently take histories of displacements, '// &
                  '*BOUNDARY with AMPLITUDE.', &
                  '*BOUNDARY, TYPE=ACCELERATION', &
                  '*BASE MOTION, DOF=1, AMPLITUDE=MOTION_X')
    call list%add('no-support', &
                  'is not held|has no supports|no support connects', &
                  'A body, or the whole model, can move without a force: the equations of a '// &
                  'static step have no solution, and a base motion has nothing to act on.', &
                  'Hold the body with *BOUNDARY, *TIE or a joint to a body that is held. A '// &
                  'plane model needs supports across its plane as well. The message names an '// &
                  'element of the body and its free motions.', &
                  'a deck without *BOUNDARY', &
                  '*BOUNDARY; BASE, 1, 3')
  end subroutine pages_from_no_effect

  subroutine pages_from_loose_block(list)
    type(page_list), intent(inout) :: list
    call list%add('loose-block', &
                  'only joints hold|can move along|can slide|is free to', &
                  'A block is held by joints alone, and the joints have no friction, cohesion '// &
                  'or strength against the motion that the message names.', &
                  'Look whether the joint lacks FRICTION, or a set lacks its support. A '// &
                  'dynamic step can run in spite of it; a static one stops where the block '// &
                  'moves.', &
                  '*JOINT LAW, NAME=A', &
                  '*JOINT LAW, NAME=A, FRICTION=0.6')
    call list%add('bad-element', &
                  'is inverted or flat|has a Jacobian|bends inward|has no area|Jacobian|'// &
                  'has a twisted face|two nodes at the same place|seven different nodes', &
                  'The corners of an element are in a wrong order, or the element is too '// &
                  'distorted: its volume is zero or negative at a corner.', &
                  'List four corners of one face anticlockwise as seen from the opposite face, '// &
                  'then the four above them. keyway-mesh prints the worst shapes of a mesh.', &
                  'corners 5 to 8 below corners 1 to 4', &
                  'corners 1 to 4 below corners 5 to 8')
    call list%add('incomplete-model', &
                  'has no section|has no stiffness|has a mass|has no *|has no joint|belongs to '// &
                  'no interface|no solid behind the joint|has no surface|needs nodes', &
                  'Something lacks its other half: elements a section, a material its '// &
                  'stiffness or density, a joint element its *JOINT.', &
                  'Add the card that the message names.', &
                  '*MATERIAL without *ELASTIC', &
                  '*ELASTIC; 2.4e10, 0.2')
    call list%add('long-element', &
                  'its unloading would release|has a length of|elements are longer than|'// &
                  'snaps back|at a lower strength', &
                  'A crack releases its energy over the length of an element. In a long '// &
                  'element the stress would have to fall faster than the element unloads '// &
                  '(snap-back).', &
                  'Refine the mesh below the length that the message names, take a tougher '// &
                  'law, or let LONG ELEMENTS=LOWER STRENGTH lower the strength so that the '// &
                  'energy stays right.', &
                  '3 m elements, G_f = 150 N/m', &
                  '1 m elements, or LONG ELEMENTS=LOWER STRENGTH')
  end subroutine pages_from_loose_block

  subroutine pages_from_plastic_table(list)
    type(page_list), intent(inout) :: list
    call list%add('plastic-table', &
                  'the yield stress falls|the first row has a plastic strain|the plastic '// &
                  'strain does not ascend', &
                  'The table of *PLASTIC begins at a plastic strain above zero, does not '// &
                  'ascend, or its yield stress falls. Where it falls the strain gathers in '// &
                  'one row of elements: results depend on their size, and with 3 G or more '// &
                  'there is no solution.', &
                  'Compare the row with the one before. For concrete that cracks take '// &
                  '*CONCRETE DAMAGED PLASTICITY, which uses the size of the elements.', &
                  '*PLASTIC; 240e6, 0.; 100e6, 0.01', &
                  '*PLASTIC; 240e6, 0.; 260e6, 0.01')
    call list%add('concrete-table', &
                  'plastic strain|table starts at|of the row before|first damage|does not '// &
                  'decrease|a first strength|strength in tension|create energy|cracks at a '// &
                  'strain|the stress falls|TYPE=GFI', &
                  'The tables of a concrete contradict each other or the law: damage that '// &
                  'heals, plastic strains that decrease, a strength in the wrong unit.', &
                  'Compare the row with the one before. keyway --material with *MATERIAL TEST '// &
                  'draws what the tables give; docs/material.md shows how to choose them.', &
                  'damage 0.9 at a small opening', &
                  'a smaller damage, or a larger opening')
  end subroutine pages_from_plastic_table

  subroutine pages_from_inner_face(list)
    type(page_list), intent(inout) :: list
    call list%add('inner-face', &
                  'lies inside the solid', &
                  'Water or a pressure acts on a face between two solids. The load pushes the '// &
                  'two apart: on the element in front it acts in the direction opposite to '// &
                  'that on its outer face.', &
                  'Name the outer face of the same elements, often the opposite one; ParaView '// &
                  'shows the elements.', &
                  'UPEL, S4', &
                  'UPEL, S6')
  end subroutine pages_from_inner_face

  subroutine pages_from_faces_apart(list)
    type(page_list), intent(inout) :: list
    call list%add('faces-apart', &
                  'do not lie on each other|lies opposite| apart|lie up to|the faces '// &
                  'overlap|facets overlap|no master facet|on the same side|share their '// &
                  'nodes|the faces of JOINT8|shares node|transmit no force|constrains no '// &
                  'node|a node of the slave surface follows|is the master surface|is the slave '// &
                  'surface|belongs to another interface|that joints cover|is a slave of joint', &
                  'Two faces that a joint, tie, contact or interface connects do not fit: they '// &
                  'lie apart, overlap, share nodes or look in the same direction.', &
                  'Look at both surfaces in ParaView. A joint needs faces with nodes of their '// &
                  'own at the same place; keyway-mesh --split makes them. The finer surface is '// &
                  'the slave.', &
                  'both surfaces on the same block', &
                  'a surface of each block')
    call list%add('equation', &
                  'first term|depend on each other in a circle|holds one displacement|breaks '// &
                  'the equation|the equation has|coefficients of the first|equations stay|an '// &
                  'equation holds|follows others|degree of freedom depends|fixed and dependent', &
                  'A linear equation eliminates its first displacement. This displacement is '// &
                  'held, is given elsewhere, or follows from itself.', &
                  'Begin the equation with a displacement that depends on the others: one that '// &
                  'has no support, tie, initial value or other equation.', &
                  '*EQUATION that begins with a held node', &
                  'the held node as a later term')
    call list%add('water', &
                  'wetted|does not reach joint|above the top of the surface|TAIL WATER|below '// &
                  'BED|the water stands along|wets the surface|in one of the steps|at '// &
                  'reservoir|is at the foot of|acts upwards', &
                  'The level, the bed, the surface or the uplift of a reservoir do not fit the '// &
                  'model: no face is wet, or the water of a joint begins nowhere.', &
                  'Compare LEVEL and BED with the heights of the surface. UPLIFT needs a '// &
                  'reservoir whose surface meets the joint at the upstream face.', &
                  'LEVEL=105 where the dam stands at z = 400 to 535', &
                  'LEVEL=505, BED=400')
    call list%add('units', &
                  'not in SI|must have the same unit|of the heaviest solid|give waves of|is a '// &
                  'coefficient, not', &
                  'The numbers of the deck are of another system of units than the defaults of '// &
                  'the keyword (1000 kg/m3, 9.81 m/s2), or of two systems.', &
                  'Use one system in the whole deck and give DENSITY and GRAVITY in it. With '// &
                  'tonnes, millimetres and seconds, water has 1e-9 and gravity is 9810; with '// &
                  'tonnes, metres and seconds (kN) water has 1.', &
                  '*RESERVOIR without DENSITY in a deck in mm', &
                  'DENSITY=1e-9, GRAVITY=9810')
    call list%add('motion-record', &
                  ''''' ends at|'''' begins at|the peak of the record|all values of '// &
                  'amplitude|record of acceleration: its values|goes on after|continues at '// &
                  'its last|the peak of the history', &
                  'A history does not fit the step: it begins or ends elsewhere, does not come '// &
                  'to rest, is zero, or has peaks between the increments.', &
                  'Compare the times of the history with those of the step. make_motion.py '// &
                  '--record --baseline corrects a record; increments of a few points of the '// &
                  'record catch its peaks.', &
                  'a record of 40 s in a step of 20 s', &
                  'a step of 40 s, or the record cut')
  end subroutine pages_from_faces_apart

  subroutine pages_from_acts_twice(list)
    type(page_list), intent(inout) :: list
    call list%add('acts-twice', &
                  'acts twice|of both act|both act|both motions add|the last one acts|of an '// &
                  'earlier step beside|add '// &
                  'up|both run|recorded once|counts once|written once|grouted twice|is there '// &
                  'already|is gone already|already, ', &
                  'The deck gives the same thing twice in a step. Loads add up; of values that '// &
                  'exclude each other the last one acts.', &
                  'Remove one of the two cards if only one of them was meant.', &
                  'gravity on DAM and on ALL', &
                  'gravity on ALL')
    call list%add('defined-twice', &
                  'is defined twice|already|used once|one name in job.h5|twice|second row|has '// &
                  'the name of', &
                  'A name or number is used twice, or a property is given twice.', &
                  'Rename or remove one of the two; the message shows the place of the first.', &
                  'two nodes 17', &
                  'node 17 and node 18')
    call list%add('wrong-kind', &
                  'is a C3D8|is a JOINT8|is a IFACE4|has no faces|no outer face|has no values '// &
                  'at|not static|has no instances', &
                  'The deck names a thing that exists and is of another kind than the keyword '// &
                  'needs: a joint element where solids are meant, a node that is on no face.', &
                  'Look at the set that the message names: often it holds more than was meant.', &
                  '*SOLID SECTION, ELSET=ALL', &
                  '*SOLID SECTION, ELSET=DAM')
    call list%add('unknown-name', &
                  'there is no |does not exist|has no node|no contact pair|does not '// &
                  'belong to any', &
                  'The deck names a node, element, set, surface, material, history or other '// &
                  'thing that does not exist, or exists only further down.', &
                  'Compare the spelling with the word after "did you mean". Sets and surfaces '// &
                  'must stand above their use. Often a misspelt keyword above is the cause, '// &
                  'which the first message then names.', &
                  '*BOUNDARY; BAES, 1, 3', &
                  '*BOUNDARY; BASE, 1, 3')
  end subroutine pages_from_acts_twice
end module pages_of_models
