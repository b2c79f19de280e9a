!> The summary of a model as text.
module model_summary
  use dam_mesh, only: fe_mesh, named_set
  use joint_points, only: dam_joint
  use kinds, only: rk
  use material_law, only: material
  use problem_definition, only: problem
  use step_summary, only: summary_of_steps
  use summary_rows, only: clock_name, name_of_base, row, unit
  use text_buffers, only: text_buffer
  use write_text, only: as_text
  implicit none
  private
  public :: summary_of, summary_of_joints, summary_of_tests

  character, parameter :: nl = new_line('a')

contains

  !> Counts, sets, materials, joints, loads and steps.
  function summary_of(model) result(text)
    type(problem), intent(in) :: model
    character(:), allocatable :: text !< lines with new_line between them
    text = 'Model'//nl//row('nodes', nodes_of(model%mesh))//nl// &
           row('elements', as_text(model%mesh%num_elements)//types_of(model))//nl// &
           row('mass', trim(merge('lumped    ', 'consistent', model%has_lumped_mass)))
    text = text//units_of(model)//titled('Node sets', sets_of('nodes', model%node_sets))// &
           titled('Element sets', sets_of('elements', model%element_sets))// &
           titled('Surfaces', surfaces_of(model))//titled('Materials', materials_of(model))// &
           titled('Joints', joints_of(model))//titled('Ties and interfaces', ties_of(model))// &
           titled('Faces of different meshes', covers_of(model))// &
           titled('Amplitudes', amplitudes_of(model))//titled('Loads', loads_of(model))// &
           summary_of_steps(model)//titled('Material tests', tests_of(model))
  end function summary_of

  !> A row where the deck is not in SI, whose units stand in the rows below.
  pure function units_of(model) result(text)
    type(problem), intent(in) :: model
    character(:), allocatable :: text
    text = model%sign_of_units
    if (text /= '') text = nl//row('units', 'not SI (a '//text//'): the numbers below are '// &
                                   'in the units of your deck')
  end function units_of

  !> A title and the rows below it; nothing where there are no rows.
  pure function titled(title, rows) result(text)
    character(*), intent(in) :: title
    character(*), intent(in) :: rows !< each begins with new_line
    character(:), allocatable :: text
    text = rows
    if (len(rows) > 0) text = nl//title//rows
  end function titled

  !> The materials and tests of `keyway --material`.
  function summary_of_tests(model) result(text)
    type(problem), intent(in) :: model
    character(:), allocatable :: text !< lines with new_line between them
    text = titled('Materials', materials_of(model))//titled('Material tests', tests_of(model))
    text = text(len(nl) + 1:)
  end function summary_of_tests

  !> The joints with their stiffnesses, for the log; '' without joints.
  pure function summary_of_joints(model) result(text)
    type(problem), intent(in) :: model
    character(:), allocatable :: text !< lines with new_line between them
    text = ''
    if (size(model%joints) > 0) text = 'Joints'//joints_of(model)
  end function summary_of_joints

  !> The number of nodes, and of those that no element has.
  pure function nodes_of(mesh) result(text)
    type(fe_mesh), intent(in) :: mesh
    character(:), allocatable :: text
    logical :: has_element(0:mesh%num_nodes)
    integer :: e, num_bare
    has_element = .false.
    do e = 1, mesh%num_elements
      has_element(max(mesh%nodes(:, e), 0)) = .true.
    end do
    num_bare = count(.not. has_element(1:))
    text = as_text(mesh%num_nodes)
    if (num_bare > 0) text = text//', '//as_text(num_bare)//' of them without an element'
  end function nodes_of

  !> Number of elements of each type.
  pure function types_of(model) result(text)
    type(problem), intent(in) :: model
    character(:), allocatable :: text
    character(8) :: kind
    logical, allocatable :: is_left(:)
    allocate (is_left(model%mesh%num_elements), source=.true.)
    text = ''
    do while (any(is_left))
      kind = model%mesh%element_type(findloc(is_left, .true., dim=1))
      text = text//', '//trim(kind)//' '//as_text(count(model%mesh%element_type == kind))
      is_left = is_left .and. model%mesh%element_type /= kind
    end do
  end function types_of

  pure function sets_of(things, sets) result(text)
    character(*), intent(in) :: things !< what the sets hold
    type(named_set), intent(in) :: sets(:)
    character(:), allocatable :: text
    type(text_buffer) :: lines
    integer :: i
    do i = 1, size(sets)
      call lines%add(nl//row(sets(i)%name, as_text(size(sets(i)%members))//' '//things))
    end do
    text = lines%contents()
  end function sets_of

  pure function surfaces_of(model) result(text)
    type(problem), intent(in) :: model
    character(:), allocatable :: text
    type(text_buffer) :: lines
    integer :: i
    do i = 1, size(model%surfaces)
      call lines%add(nl//row(model%surfaces(i)%name, as_text(size(model%surfaces(i)%face))// &
                             ' faces'))
    end do
    text = lines%contents()
  end function surfaces_of

  pure function materials_of(model) result(text)
    type(problem), intent(in) :: model
    character(:), allocatable :: text
    integer :: i
    text = ''
    do i = 1, size(model%materials)
      associate (now => model%materials(i))
        text = text//nl//row(now%name, elastic_text(now, unit(model, ' Pa'))//', density '// &
                             as_text(now%density)//unit(model, ' kg/m3')//', damping ALPHA '// &
                             as_text(now%alpha)//' 1/s, BETA '// &
                             as_text(now%beta)//' s, BASE '// &
                             name_of_base(now%damps_current)//elements_of(model, i))
        if (allocated(now%expansion)) text = text//nl//row('', expansion_text(now))
        if (allocated(now%remark)) text = text//nl//row('', now%remark)
      end associate
    end do
  end function materials_of

  !> 'E .. Pa, nu ..'; a UMAT exposes no elastic constants.
  pure function elastic_text(now, pascal) result(text)
    type(material), intent(in) :: now
    character(*), intent(in) :: pascal !< ' Pa', or '' in a deck in other units
    character(:), allocatable :: text
    text = 'E '//as_text(now%young)//pascal//', nu '//as_text(now%poisson)
    if (now%young <= 0.0_rk) text = 'a UMAT'
  end function elastic_text

  !> 'expansion 1e-5 1/K', of a table the first and the last coefficient.
  pure function expansion_text(now) result(text)
    type(material), intent(in) :: now
    character(:), allocatable :: text
    associate (alpha => now%expansion%alpha)
      text = 'expansion '//as_text(alpha(1))
      if (size(alpha) > 1) text = text//' to '//as_text(alpha(size(alpha)))
    end associate
    text = text//' 1/K'
  end function expansion_text

  !> '; 12 elements', '' without elements.
  pure function elements_of(model, material) result(text)
    type(problem), intent(in) :: model
    integer, intent(in) :: material
    character(:), allocatable :: text
    text = ''
    if (model%mesh%num_elements == 0) return
    text = '; '//as_text(count(model%mesh%material_of_element == material))//' elements'
  end function elements_of

  pure function tests_of(model) result(text)
    type(problem), intent(in) :: model
    character(:), allocatable :: text
    integer :: i
    text = ''
    do i = 1, size(model%tests)
      associate (now => model%tests(i))
        text = text//nl//row(now%name, now%kind//' of '//model%materials(now%material)%name// &
                             ', length '//as_text(now%length)//' m, '// &
                             as_text(size(now%legs))//' legs, '// &
                             as_text(sum(now%legs%num_increments))//' increments')
      end associate
    end do
  end function tests_of

  pure function joints_of(model) result(text)
    type(problem), intent(in) :: model
    character(:), allocatable :: text
    real(rk) :: k(3)
    integer :: i
    text = ''
    do i = 1, size(model%joints)
      call model%joints(i)%law%reference_stiffness(k)
      text = text//nl//row(model%joints(i)%name, make_of(model%joints(i))//', '// &
                           as_text(model%joints(i)%num_points)// &
                           ' points, '//as_text(sum(model%joints(i)%area))// &
                           unit(model, ' m2')//', KN '//as_text(k(1))//unit(model, ' Pa/m')// &
                           ', KT '//as_text(k(2))//unit(model, ' Pa/m')//', law '// &
                           model%joints(i)%law%name)
    end do
  end function joints_of

  !> What a joint is made of, and where its law is evaluated.
  pure function make_of(joint) result(text)
    type(dam_joint), intent(in) :: joint
    character(:), allocatable :: text
    text = 'surfaces'
    if (joint%is_matching) text = 'JOINT8'
    if (.not. joint%is_nodal) text = text//' with Gauss points'
  end function make_of

  !> Guests without a law: exact ties, springs.
  function ties_of(model) result(text)
    type(problem), intent(in) :: model
    character(:), allocatable :: text
    integer :: i
    text = ''
    do i = 1, size(model%guests)
      text = text//nl//row(model%guests(i)%item%name, model%guests(i)%item%describe())
    end do
  end function ties_of

  !> How well faces of different meshes cover each other.
  pure function covers_of(model) result(text)
    type(problem), intent(in) :: model
    character(:), allocatable :: text
    integer :: i
    text = ''
    do i = 1, size(model%covers)
      associate (now => model%covers(i)%cover)
        text = text//nl//row(model%covers(i)%name, '*'//model%covers(i)%kind//': '// &
                             as_text(now%covered_area)//' of '//as_text(now%slave_area)// &
                             unit(model, ' m2')//' of the slave face covered, largest gap '// &
                             as_text(now%largest_gap)//unit(model, ' m')//', largest overlap '// &
                             as_text(now%largest_overlap)//unit(model, ' m'))
      end associate
    end do
  end function covers_of

  pure function amplitudes_of(model) result(text)
    type(problem), intent(in) :: model
    character(:), allocatable :: text
    integer :: i
    text = ''
    do i = 1, size(model%amplitudes)
      associate (now => model%amplitudes(i))
        text = text//nl//row(now%name, as_text(size(now%time))//' points, '// &
                             as_text(now%time(1))//' to '//as_text(now%time(size(now%time)))// &
                             ' s of the '//clock_name(now%uses_total_time)//', values '// &
                             as_text(minval(now%value))//' to '//as_text(maxval(now%value)))
      end associate
    end do
  end function amplitudes_of

  pure function loads_of(model) result(text)
    type(problem), intent(in) :: model
    character(:), allocatable :: text
    type(text_buffer) :: lines
    integer :: i
    do i = 1, size(model%loads)
      call lines%add(nl//row(as_text(i), model%loads(i)%item%name))
    end do
    text = lines%contents()
  end function loads_of
end module model_summary
