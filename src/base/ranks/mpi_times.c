/* Time in calls of MPI from C: those of this program and of PETSc, not those of MUMPS, which is
 * written in Fortran. MPI's profiling interface gives each procedure a second name. */
#include <mpi.h>

static double seconds;

double keyway_exchange_seconds(void) { return seconds; }

#define TIMED(procedure, parameters, arguments)       \
  int MPI_##procedure parameters                      \
  {                                                   \
    const double start = PMPI_Wtime();                \
    const int status = PMPI_##procedure arguments;    \
    seconds += PMPI_Wtime() - start;                  \
    return status;                                    \
  }

TIMED(Allreduce, (const void *own, void *all, int n, MPI_Datatype type, MPI_Op op, MPI_Comm comm),
      (own, all, n, type, op, comm))
TIMED(Reduce, (const void *own, void *all, int n, MPI_Datatype type, MPI_Op op, int to,
               MPI_Comm comm), (own, all, n, type, op, to, comm))
TIMED(Bcast, (void *x, int n, MPI_Datatype type, int from, MPI_Comm comm), (x, n, type, from, comm))
TIMED(Barrier, (MPI_Comm comm), (comm))
TIMED(Allgatherv, (const void *own, int n, MPI_Datatype type, void *all, const int *counts,
                   const int *starts, MPI_Datatype types, MPI_Comm comm),
      (own, n, type, all, counts, starts, types, comm))
TIMED(Gatherv, (const void *own, int n, MPI_Datatype type, void *all, const int *counts,
                const int *starts, MPI_Datatype types, int to, MPI_Comm comm),
      (own, n, type, all, counts, starts, types, to, comm))
TIMED(Recv, (void *x, int n, MPI_Datatype type, int from, int tag, MPI_Comm comm, MPI_Status *end),
      (x, n, type, from, tag, comm, end))
TIMED(Wait, (MPI_Request *request, MPI_Status *end), (request, end))
TIMED(Waitany, (int n, MPI_Request *requests, int *done, MPI_Status *end), (n, requests, done, end))
TIMED(Waitall, (int n, MPI_Request *requests, MPI_Status *ends), (n, requests, ends))

/* Waiting that is no call of MPI. */
void keyway_add_waiting(double waited) { seconds += waited; }
