!> The ledger of a run in job.h5 (layout: docs/results.md).
module hdf5_ledger
  use kinds, only: rk
  use hdf5_files, only: hdf5_file
  use run_ledger, only: ledger, ledger_part
  use timer, only: peak_memory
  implicit none
  private
  public :: write_ledger

contains

  !> Writes all parts, in arrays of the same order.
  subroutine write_ledger(file, costs)
    type(hdf5_file), intent(inout) :: file
    type(ledger), intent(in) :: costs
    type(ledger_part), allocatable :: parts(:)
    character(:), allocatable :: texts(:)
    real(rk) :: wall_time
    integer :: i, width
    call costs%read_parts(parts, wall_time)
    if (size(parts) == 0) return
    call file%make_group('/ledger')
    call file%set('/ledger', 'wall_s', wall_time)
    call file%set('/ledger', 'peak_memory_mb', peak_memory())
    width = maxval([(len(parts(i)%name()) + len(parts(i)%kind), i=1, size(parts))])
    allocate (character(width) :: texts(size(parts)))
    do i = 1, size(parts)
      texts(i) = parts(i)%name()
    end do
    call file%put_texts('/ledger/name', texts)
    do i = 1, size(parts)
      texts(i) = parts(i)%kind
    end do
    call file%put_texts('/ledger/kind', texts)
    do i = 1, size(parts)
      texts(i) = parts(i)%work
    end do
    call file%put_texts('/ledger/work', texts)
    do i = 1, size(parts)
      texts(i) = parts(i)%effect
    end do
    call file%put_texts('/ledger/effect', texts)
    call file%put('/ledger/wall_s', parts%wall_time)
    call file%put('/ledger/memory_mb', parts%memory)
    call file%put('/ledger/calls', parts%num_calls)
  end subroutine write_ledger
end module hdf5_ledger
