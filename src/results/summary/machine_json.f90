!> The machine of a run in job.json, and what of it the run uses.
module machine_json
  use blas_threads, only: kernels_of_blas
  use json_writer, only: json_text
  use machine, only: memory_of_machine, num_processors, processor_name
  use omp_lib, only: omp_get_max_threads
  implicit none
  private
  public :: put_machine

contains

  !> Processor, number of processors and threads, kernels of the BLAS, memory.
  subroutine put_machine(json)
    type(json_text), intent(inout) :: json
    call json%open_object('machine')
    call json%put_text(processor_name(), 'processor')
    call json%put_integer(num_processors(), 'processors')
    call json%put_integer(omp_get_max_threads(), 'threads')
    call json%put_text(kernels_of_blas(), 'blas_kernels')
    call json%put_integer(nint(memory_of_machine()), 'memory_mb')
    call json%close_object()
  end subroutine put_machine
end module machine_json
