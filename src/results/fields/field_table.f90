!> The one table of fields. Keywords, messages, result files, `keyway --fields` and docs/fields.md
!> are made from it. A new field is one row here and the procedure that computes it.
!>
!> Files with several fields keep the order of the table.
module field_table
  use field_type, only: result_field, at_nodes, at_points, at_joints, on_faces, &
                        at_elements, by_solver, by_recovery, by_law, by_joint, by_heat, &
                        scalar, vector, tensor, counted
  use motion_fields, only: displacement, velocity, acceleration, reaction, has_motion, &
                           has_reactions
  use solid_fields, only: stress_on_nodes, stress_of_solids, stress_of_block, strain_on_nodes, &
                          strain_of_solids, strain_of_block, principals_on_nodes, &
                          principals_of_solids, extreme_on_nodes, extreme_near_nodes, &
                          extreme_of_block, width_in_blocks, law_width, law_on_nodes, &
                          law_of_solids, law_of_block
  use derived_fields, only: energy_of_solids, energy_on_nodes, mises_of_solids, mises_on_nodes
  use error_fields, only: error_of_elements, error_on_nodes
  use joint_fields, only: has_joints, opening_on_nodes, opening_of_joint, slip_of_joint, &
                          traction_of_joint, state_of_joint, used_slip_of_joint, &
                          water_of_joint, phase_of_joint
  use stage_fields, only: stage_of_elements, stage_on_nodes, width_in_stages
  use json_writer, only: lower
  use thermal_fields, only: temperature, width_of_heat, width_of_expansion, expansion_on_nodes, &
                            expansion_of_solids
  implicit none
  private
  public :: list_fields, find_field, choices_of, fields_in_words, columns_of_joints
  public :: ending_of_points

  integer, parameter :: most_fields = 100
  !> Of the names of fields whose envelope is that of integration points.
  character(*), parameter :: ending_of_points = '_POINT'

contains

  !> All fields.
  subroutine list_fields(table)
    type(result_field), allocatable, intent(out) :: table(:)
    type(result_field) :: rows(most_fields)
    integer :: last, i
    last = 0
    call list_motion(rows, last)
    call list_stresses(rows, last)
    call list_stages(rows, last)
    call list_fields_of_joints(rows, last)
    call list_fields_of_laws(rows, last)
    allocate (table(last))
    do i = 1, last
      table(i) = rows(i)
    end do
  end subroutine list_fields

  !> Fields on nodes.
  subroutine list_motion(rows, last)
    type(result_field), intent(inout) :: rows(:)
    integer, intent(inout) :: last !< number of fields so far
    call enter(rows, last, result_field( &
               name='U', meaning='displacement', endings=vector, unit='m', place=at_nodes, &
               remark='Relative to the base where the base moves. The envelope keeps the length.', &
               provider=by_solver, requests='NODE PRINT | NODE FILE | ENVELOPE', &
               on_nodes=displacement))
    call enter(rows, last, result_field( &
               name='V', meaning='velocity', endings=vector, unit='m/s', place=at_nodes, &
               remark='Relative to the base. Zero in a static step.', &
               provider=by_solver, requests='NODE PRINT | NODE FILE', on_nodes=velocity, &
               is_there=has_motion))
    call enter(rows, last, result_field( &
               name='A', meaning='acceleration', endings=vector, unit='m/s2', place=at_nodes, &
               remark='Relative to the base. Zero in a static step.', &
               provider=by_solver, requests='NODE PRINT | NODE FILE', on_nodes=acceleration, &
               is_there=has_motion))
    call enter(rows, last, result_field( &
               name='RF', meaning='reaction', endings=vector, unit='N', place=at_nodes, &
               remark='Zero where no degree of freedom is prescribed. In a dynamic step RF '// &
               'is in equilibrium with the stresses and tractions at the end of the '// &
               'increment, A with the weighted forces of the increment (theory.md, 7.2, RF and '// &
               'A); the two differ with ALPHA other than 0, with joints and with '// &
               'RECOVERY=ENERGY.', &
               provider=by_solver, requests='NODE PRINT | NODE FILE', on_nodes=reaction, &
               is_there=has_reactions))
    call enter(rows, last, result_field( &
               name='TEMP', meaning='temperature', endings=scalar, unit='K', place=at_nodes, &
               remark='Only in models with temperatures (*TEMPERATURE, *INITIAL CONDITIONS).', &
               provider=by_heat, requests='NODE PRINT | NODE FILE', count=width_of_heat, &
               on_nodes=temperature))
  end subroutine list_motion

  !> Strains and stresses of solids.
  subroutine list_stresses(rows, last)
    type(result_field), intent(inout) :: rows(:)
    integer, intent(inout) :: last !< number of fields so far
    call enter(rows, last, result_field( &
               name='S', meaning='stress', endings=tensor, unit='Pa', place=at_points, &
               remark='Tension is positive.', &
               provider=by_recovery, requests='EL PRINT | EL FILE', on_nodes=stress_on_nodes, &
               of_solids=stress_of_solids, of_block=stress_of_block))
    call enter(rows, last, result_field( &
               name='E', meaning='strain', endings=tensor, unit='1', place=at_points, &
               remark='Shear components are engineering strains.', &
               provider=by_recovery, requests='EL PRINT | EL FILE', on_nodes=strain_on_nodes, &
               of_solids=strain_of_solids, of_block=strain_of_block))
    call enter(rows, last, result_field( &
               name='THE', meaning='thermal strain', endings=tensor, unit='1', place=at_points, &
               remark='Since the initial temperature, or since the element has appeared; E '// &
               'includes the thermal strain. Only in models with temperatures and *EXPANSION.', &
               provider=by_heat, requests='EL PRINT | EL FILE', &
               count=width_of_expansion, on_nodes=expansion_on_nodes, &
               of_solids=expansion_of_solids))
    call enter(rows, last, result_field( &
               name='SP', meaning='principal stresses', endings=vector, unit='Pa', &
               place=at_points, remark='SP1 is the largest. On nodes those of the mean tensor.', &
               provider=by_recovery, requests='EL PRINT | EL FILE', &
               on_nodes=principals_on_nodes, of_solids=principals_of_solids))
    call list_scalars(rows, last)
    call enter(rows, last, result_field( &
               name='S1', meaning='largest tension', endings=scalar, unit='Pa', place=at_nodes, &
               remark='Largest principal stress of the mean tensor at a node.', &
               provider=by_recovery, requests='ENVELOPE', on_nodes=extreme_on_nodes))
    call enter(rows, last, result_field( &
               name='S3', meaning='largest compression', endings=scalar, unit='Pa', &
               place=at_nodes, wants_smallest=.true., &
               remark='Smallest principal stress of the mean tensor at a node.', &
               provider=by_recovery, requests='ENVELOPE', on_nodes=extreme_on_nodes))
    call enter(rows, last, result_field( &
               name='ERROR', meaning='error of the mesh in the stresses', endings=scalar, &
               unit='1', place=at_elements, &
               remark='Estimated part of an element in the error of the stresses, over '// &
               'the norm of the stresses of the whole model (energy norm). '// &
               'The squares of all elements add up to the square of "relative" in job.json. '// &
               'On nodes the mean of the elements.', &
               provider=by_recovery, requests='EL FILE', on_nodes=error_on_nodes, &
               of_elements=error_of_elements))
    call list_stresses_of_laws(rows, last)
  end subroutine list_stresses

  !> Scalars that follow from the stresses.
  subroutine list_scalars(rows, last)
    type(result_field), intent(inout) :: rows(:)
    integer, intent(inout) :: last !< number of fields so far
    call enter(rows, last, result_field( &
               name='MISES', meaning='equivalent stress of von Mises', endings=scalar, unit='Pa', &
               place=at_points, remark='On nodes that of the mean tensor.', &
               provider=by_recovery, requests='EL PRINT | EL FILE', on_nodes=mises_on_nodes, &
               of_solids=mises_of_solids))
    call enter(rows, last, result_field( &
               name='ENER', meaning='elastic energy per volume', endings=scalar, unit='J/m3', &
               place=at_points, remark='Recovered by unloading; what is dissipated is in the '// &
               'energy balance. On nodes the mean of the nearest points.', &
               provider=by_recovery, requests='EL PRINT | EL FILE', on_nodes=energy_on_nodes, &
               of_solids=energy_of_solids))
  end subroutine list_scalars

  !> Stresses at the points of materials with a law.
  subroutine list_stresses_of_laws(rows, last)
    type(result_field), intent(inout) :: rows(:)
    integer, intent(inout) :: last !< number of fields so far
    call enter(rows, last, result_field( &
               name='S1'//ending_of_points, meaning='largest tension at integration points', &
               endings=scalar, unit='Pa', place=at_points, &
               remark='Largest principal stress at the points of materials with a law, as the '// &
               'law gives it: concrete does not exceed f_t in uniaxial tension. S1 at nodes '// &
               'extrapolates and may. On nodes the mean of the nearest points.', &
               provider=by_law, requests='ENVELOPE', count=width_in_blocks, &
               on_nodes=extreme_near_nodes, of_block=extreme_of_block))
    call enter(rows, last, result_field( &
               name='S3'//ending_of_points, meaning='largest compression at integration points', &
               endings=scalar, unit='Pa', place=at_points, wants_smallest=.true., &
               remark='Smallest principal stress at the points of materials with a law, as the '// &
               'law gives it. On nodes the mean of the nearest points.', &
               provider=by_law, requests='ENVELOPE', count=width_in_blocks, &
               on_nodes=extreme_near_nodes, of_block=extreme_of_block))
  end subroutine list_stresses_of_laws

  !> When elements were added.
  subroutine list_stages(rows, last)
    type(result_field), intent(inout) :: rows(:)
    integer, intent(inout) :: last !< number of fields so far
    call enter(rows, last, result_field( &
               name='STAGE', meaning='step in which an element was added', endings=scalar, &
               unit='1', is_integer=.true., place=at_elements, &
               remark='0 where the element is absent, 1 where it has been there since the '// &
               'first step. On nodes the smallest of the elements that are there. '// &
               'Only in models with *MODEL CHANGE.', &
               provider='stages', requests='EL FILE', count=width_in_stages, &
               on_nodes=stage_on_nodes, of_elements=stage_of_elements))
  end subroutine list_stages

  !> Fields of joints.
  subroutine list_fields_of_joints(rows, last)
    type(result_field), intent(inout) :: rows(:)
    integer, intent(inout) :: last !< number of fields so far
    call enter(rows, last, result_field( &
               name='OPENING', meaning='distance between the faces of joints', endings=scalar, &
               unit='m', place=at_joints, &
               remark='Normal relative displacement with the GAP added, '// &
               'negative while the joint is compressed. On nodes the mean of the adjacent '// &
               'points. The envelope keeps 0 where a joint is closed.', &
               provider=by_joint, requests='JOINT PRINT | NODE FILE | EL FILE | ENVELOPE', &
               on_nodes=opening_on_nodes, of_joint=opening_of_joint, is_there=has_joints))
    call enter(rows, last, result_field( &
               name='SLIP', meaning='irrecoverable sliding of joints', endings='1,2', unit='m', &
               place=at_joints, remark='With the normal n from the master to the slave, SLIP1 '// &
               'is along e3 x n (along x where n is along z) and SLIP2 along the product of n '// &
               'and that axis; e3 is the z axis of the deck, whatever UP and the weight are '// &
               '(theory.md, 2.1). Where z points up, SLIP1 is horizontal and SLIP2 up the '// &
               'joint; in a level joint both are horizontal.', &
               provider=by_joint, requests='JOINT PRINT', of_joint=slip_of_joint))
    call enter(rows, last, result_field( &
               name='TRACTION', meaning='traction of joints', stem='T', endings='N,1,2', &
               unit='Pa', place=at_joints, &
               remark='Normal, and along the axes of the slip. Tension is '// &
               'positive.', provider=by_joint, requests='JOINT PRINT', &
               of_joint=traction_of_joint))
    call enter(rows, last, result_field( &
               name='STATE', meaning='contact of joints', endings=scalar, unit='1', &
               is_integer=.true., place=at_joints, &
               remark='0 open, 1 stick, 2 slip, 3 bonded; on drawn faces -1 '// &
               'where both faces share a node.', &
               provider=by_joint, requests='JOINT PRINT', of_joint=state_of_joint))
    call enter(rows, last, result_field( &
               name='REACH_USED', meaning='used fraction of the admissible slip', endings=scalar, &
               unit='1', place=on_faces, remark='Tangential relative displacement '// &
               'divided by the admissible slip; 0 for JOINT8.', &
               provider=by_joint, requests='', of_joint=used_slip_of_joint))
    call enter(rows, last, result_field( &
               name='WATER', meaning='water pressure in joints', endings=scalar, unit='Pa', &
               place=at_joints, remark='Only in joints with UPLIFT (*JOINT LAW). Zero where '// &
               'GROUTED is 0.', &
               provider='uplift', requests='', of_joint=water_of_joint))
    call enter(rows, last, result_field( &
               name='GROUTED', meaning='stage of joints', endings=scalar, unit='1', &
               is_integer=.true., place=at_joints, &
               remark='0 an element behind the point is absent, 1 not grouted yet, '// &
               '2 the whole law. Only in models with stages.', &
               provider='stages', requests='', of_joint=phase_of_joint))
  end subroutine list_fields_of_joints

  !> Fields of the laws of inelastic solids.
  subroutine list_fields_of_laws(rows, last)
    type(result_field), intent(inout) :: rows(:)
    integer, intent(inout) :: last !< number of fields so far
    call enter(rows, last, result_field( &
               name='PE', meaning='plastic strain', endings=tensor, unit='1', place=at_points, &
               remark='Of concrete and metals. Shear components are engineering strains.', &
               provider=by_law, requests='EL PRINT | EL FILE', count=law_width, &
               on_nodes=law_on_nodes, of_solids=law_of_solids, of_block=law_of_block))
    call enter(rows, last, result_field( &
               name='PEEQ', meaning='equivalent plastic strain', endings=scalar, unit='1', &
               place=at_points, remark='Of metals (*PLASTIC): the sum of its increments.', &
               provider=by_law, requests='EL PRINT | EL FILE', count=law_width, &
               on_nodes=law_on_nodes, of_solids=law_of_solids, of_block=law_of_block))
    call enter(rows, last, result_field( &
               name='PEMAG', meaning='size of the plastic strain', endings=scalar, unit='1', &
               place=at_points, remark='sqrt(2/3 e:e) of the present plastic strain e.', &
               provider=by_law, requests='EL PRINT | EL FILE', count=law_width, &
               on_nodes=law_on_nodes, of_solids=law_of_solids, of_block=law_of_block))
    call enter(rows, last, result_field( &
               name='DAMAGET', meaning='damage in tension', endings=scalar, unit='1', &
               place=at_points, has_means=.true., remark='Of concrete, 0 to 1.', &
               provider=by_law, requests='EL PRINT | EL FILE | ENVELOPE', count=law_width, &
               on_nodes=law_on_nodes, of_solids=law_of_solids, of_block=law_of_block))
    call enter(rows, last, result_field( &
               name='DAMAGEC', meaning='damage in compression', endings=scalar, unit='1', &
               place=at_points, has_means=.true., remark='Of concrete, 0 to 1.', &
               provider=by_law, requests='EL PRINT | EL FILE | ENVELOPE', count=law_width, &
               on_nodes=law_on_nodes, of_solids=law_of_solids, of_block=law_of_block))
    call enter(rows, last, result_field( &
               name='SDV', meaning='state variables of the material', endings=counted, unit='-', &
               place=at_points, remark='All of a UMAT (*DEPVAR); those of concrete are listed '// &
               'with its law. The material with most variables gives their number.', &
               provider=by_law, requests='EL PRINT | EL FILE', count=law_width, &
               on_nodes=law_on_nodes, of_solids=law_of_solids, of_block=law_of_block))
  end subroutine list_fields_of_laws

  !> Adds a row. Its stem is the name of the field unless the row has its own.
  subroutine enter(rows, last, row)
    type(result_field), intent(inout) :: rows(:)
    integer, intent(inout) :: last !< number of fields so far
    type(result_field), intent(in) :: row
    last = last + 1
    rows(last) = row
    if (.not. allocated(row%stem)) rows(last)%stem = row%name
  end subroutine enter

  !> Position of a field in the table, 0 where it is unknown.
  pure integer function find_field(table, name) result(found)
    type(result_field), intent(in) :: table(:)
    character(*), intent(in) :: name !< upper case
    do found = size(table), 1, -1
      if (table(found)%name == name) return
    end do
  end function find_field

  !> Words allowed in a data line of a keyword: fields, for *JOINT PRINT also components.
  function choices_of(keyword) result(choices)
    character(*), intent(in) :: keyword
    character(:), allocatable :: choices !< separated by ' | '
    type(result_field), allocatable :: table(:)
    integer :: i, k
    call list_fields(table)
    choices = ''
    do i = 1, size(table)
      if (table(i)%is_allowed_in(keyword)) choices = choices//' | '//table(i)%name
    end do
    do i = 1, size(table)
      if (table(i)%place /= at_joints .or. table(i)%endings == scalar) cycle
      if (.not. table(i)%is_allowed_in(keyword)) cycle
      do k = 1, table(i)%num_endings()
        choices = choices//' | '//table(i)%component(k)
      end do
    end do
    choices = choices(4:)
  end function choices_of

  !> 'U displacement, V velocity': the fields of a keyword with their meaning.
  function fields_in_words(keyword) result(text)
    character(*), intent(in) :: keyword
    character(:), allocatable :: text
    type(result_field), allocatable :: table(:)
    integer :: i
    call list_fields(table)
    text = ''
    do i = 1, size(table)
      if (.not. table(i)%is_allowed_in(keyword)) cycle
      text = text//', '//table(i)%name//' '//table(i)%meaning
    end do
    text = text(3:)
  end function fields_in_words

  !> 'opening [m], slip1, slip2 [m]': the columns of *JOINT PRINT after the coordinates.
  function columns_of_joints() result(text)
    character(:), allocatable :: text
    type(result_field), allocatable :: table(:)
    integer :: i, k
    call list_fields(table)
    text = ''
    do i = 1, size(table)
      if (.not. table(i)%is_allowed_in('JOINT PRINT')) cycle
      do k = 1, table(i)%num_endings()
        text = text//', '//lower(table(i)%component(k))
      end do
      if (table(i)%unit /= '1') text = text//' ['//table(i)%unit//']'
    end do
    text = text(3:)
  end function columns_of_joints
end module field_table
