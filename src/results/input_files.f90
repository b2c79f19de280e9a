!> The files that a run reads: it must not write over them.
module input_files
  use errors, only: deck_is_wrong, error_type, raise
  use file_identity, only: add_path, file_path, is_same_file
  use problem_definition, only: problem
  implicit none
  private
  public :: inputs_of, refuse_inputs

contains

  !> A file that is read must not be one that the run writes.
  subroutine refuse_inputs(model, paths, error)
    type(problem), intent(in) :: model
    type(file_path), intent(in) :: paths(:) !< that will be written
    type(error_type), allocatable, intent(out) :: error
    type(file_path), allocatable :: inputs(:)
    integer :: i, p
    inputs = inputs_of(model)
    do i = 1, size(inputs)
      do p = 1, size(paths)
        if (.not. is_same_file(inputs(i)%path, paths(p)%path)) cycle
        call raise(error, "keyway: the run would write over '"//inputs(i)%path// &
                   "', which it reads, as '"//paths(p)%path// &
                   "'; rename the file, or give another folder with -o", deck_is_wrong)
        return
      end do
    end do
  end subroutine refuse_inputs

  !> All files that the run reads.
  function inputs_of(model) result(inputs)
    type(problem), intent(in) :: model
    type(file_path), allocatable :: inputs(:)
    integer :: i
    allocate (inputs(0))
    if (allocated(model%inputs)) inputs = model%inputs
    call add_path(inputs, model%deck_file)
    if (.not. associated(model%umat)) return
    do i = 1, size(model%umat%files)
      call add_path(inputs, model%umat%files(i)%path)
    end do
  end function inputs_of
end module input_files
