!> What every load can do beyond a guest. A load is a constant pattern; its factor in time belongs to
!> the step.
module applied_load
  use guest_type, only: guest
  implicit none
  private
  public :: load, load_slot

  type, abstract, extends(guest) :: load
    character(:), allocatable :: family !< its keyword, for OP=NEW: 'CLOAD', 'DLOAD', ...
    character(:), allocatable :: target !< identity for OP=MOD: same target, new magnitude
  end type load

  type :: load_slot
    class(load), allocatable :: item
  end type load_slot
end module applied_load
