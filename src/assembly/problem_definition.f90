!> The problem: filled by the keywords, read by the solvers. Effects are guests in its lists.
module problem_definition
  use card_digests, only: card_digest
  use file_identity, only: file_path
  use instance_list, only: mesh_instance
  use dam_mesh, only: fe_mesh, named_set, surface
  use amplitudes, only: amplitude
  use heat_plan, only: heating
  use stage_plan, only: stages
  use step_plan, only: step, initial_value
  use material_law, only: material
  use material_tests, only: material_test
  use joint_points, only: dam_joint
  use guest_type, only: guest_slot
  use surface_segments, only: named_cover
  use applied_load, only: load_slot
  use inelastic_blocks, only: inelastic_block
  use umat_loader, only: user_library
  use unknown_layout, only: choose_solver
  use kinds, only: rk
  implicit none
  private
  public :: problem

  !> Immutable once the deck is read, except for the elements that a stage takes out of the mesh.
  type :: problem
    character(:), allocatable :: deck_file !< as given on the command line
    character(:), allocatable :: heading
    type(mesh_instance), allocatable :: instances(:) !< of parts; none in most decks
    type(mesh_instance) :: outside !< what stands outside the instances
    type(file_path), allocatable :: inputs(:) !< all files that were read
    type(card_digest), allocatable :: cards(:) !< of the deck, without material tests
    type(fe_mesh) :: mesh
    type(named_set), allocatable :: node_sets(:), element_sets(:)
    type(surface), allocatable :: surfaces(:)
    type(amplitude), allocatable :: amplitudes(:)
    type(material), allocatable :: materials(:)
    type(material_test), allocatable :: tests(:) !< of materials at one point
    logical :: has_lumped_mass = .false.
    type(dam_joint), allocatable :: joints(:)
    type(guest_slot), allocatable :: guests(:) !< of every step, without joints
    type(named_cover), allocatable :: covers(:) !< cover of faces of different meshes
    type(inelastic_block), allocatable :: inelastic(:) !< solids whose law is not linear
    type(load_slot), allocatable :: loads(:)
    type(initial_value), allocatable :: initial_values(:)
    type(step), allocatable :: steps(:)
    !> Largest acceleration of the weights of all steps, 0 without weights [m/s2]
    real(rk) :: gravity = 0.0_rk
    character(:), allocatable :: sign_of_units !< that the deck is not in SI; '' for one in SI
    logical :: has_other_acceleration = .false. !< its unit is, or may be, another one than m/s2
    type(stages) :: stages !< elements that come and go, joints that are grouted
    type(heating) :: heat !< temperatures
    type(user_library), pointer :: umat => null() !< loaded library of the user, null for none
    integer :: equation_solver = choose_solver !< of equations that are divided among ranks
    integer :: upstream_surface = 0 !< surface of the first reservoir, 0 for none
  end type problem
end module problem_definition
