!> What the command line says of the meaning of a deck.
module deck_options
  implicit none
  private
  public :: reading_options

  type :: reading_options
    logical :: is_for_tests = .false. !< of materials: the model may be incomplete
    logical :: takes_small_strain = .false. !< NLGEOM=YES is analysed with small strains
    character(4) :: c3d8 = '' !< meaning of C3D8: 'FULL', 'BBAR'; '': by the deck
  end type reading_options
end module deck_options
