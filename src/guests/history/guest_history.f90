!> What a guest changes in time: the contract of histories.
!>
!> A state holds one history for each guest that has one: points of a joint, points of inelastic
!> solids, slip of springs. It saves and loads itself; the energy balance asks its guest for its
!> energies.
module guest_history
  use kinds, only: rk
  use archive_type, only: archive
  implicit none
  private
  public :: history, history_slot, stored_work

  type, abstract :: history
  contains
    procedure(save_history), deferred :: save
    procedure(load_history), deferred :: load
  end type history

  !> A history in a list; unallocated for a guest without history.
  type :: history_slot
    class(history), allocatable :: item
  end type history_slot

  !> Energies since the start of the analysis [J].
  type :: stored_work
    real(rk) :: stored = 0.0_rk !< elastic, in addition to 1/2 q K q of the matrix
    real(rk) :: friction = 0.0_rk !< dissipated by sliding
    real(rk) :: fracture = 0.0_rk !< dissipated by cracking and crushing
    real(rk) :: crushing = 0.0_rk !< the part of `fracture` in compression
  end type stored_work

  abstract interface
    !> Writes all components into the present group.
    subroutine save_history(self, file)
      import :: history, archive
      implicit none
      class(history), intent(in) :: self
      class(archive), intent(inout) :: file
    end subroutine save_history

    !> Reads all components from the present group. The history must be that of the start of the
    !> analysis, which fixes the sizes.
    subroutine load_history(self, file)
      import :: history, archive
      implicit none
      class(history), intent(inout) :: self
      class(archive), intent(inout) :: file
    end subroutine load_history
  end interface
end module guest_history
