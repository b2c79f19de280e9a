!> The writers of a run. A new writer needs one file and one line here.
module writer_catalogue
  use result_writer, only: writer
  use write_history, only: history_files
  use write_energy, only: energy_file
  use write_damage, only: damage_file
  use write_hdf5, only: hdf5_results
  use write_vtk, only: vtk_series
  use write_joint_vtk, only: joint_series
  implicit none
  private
  public :: writer_item, list_writers

  !> One writer of the list.
  type :: writer_item
    class(writer), allocatable :: item
    character(:), allocatable :: label !< name in the ledger
  end type writer_item

  integer, parameter :: most_writers = 20

contains

  !> All writers, in the order of writing.
  subroutine list_writers(writers)
    type(writer_item), allocatable, intent(out) :: writers(:)
    type(writer_item) :: room(most_writers)
    integer :: last, i
    last = 0
    call add_writer(history_files(), 'CSV')
    call add_writer(energy_file(), 'CSV')
    call add_writer(damage_file(), 'CSV')
    call add_writer(hdf5_results(), 'HDF5')
    call add_writer(vtk_series(), 'VTK')
    call add_writer(joint_series(), 'VTK of joints')
    allocate (writers(last))
    do i = 1, last
      call move_alloc(room(i)%item, writers(i)%item)
      writers(i)%label = room(i)%label
    end do

  contains

    !> Adds a writer.
    subroutine add_writer(item, label)
      class(writer), intent(in) :: item
      character(*), intent(in) :: label
      last = last + 1
      allocate (room(last)%item, source=item)
      room(last)%label = label
    end subroutine add_writer
  end subroutine list_writers
end module writer_catalogue
