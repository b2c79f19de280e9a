/* Behind ranks.f90 with KEYWAY_PETSC: the processes that mpiexec or srun has started. */
#include <limits.h>
#include <mpi.h>
#include <stddef.h>
#include <stdlib.h>
#include <time.h>

static int number = 1, rank, number_here = 1, is_started, is_alone;
void keyway_add_waiting(double waited); /* of mpi_times.c */

static MPI_Comm meetings; /* its messages cannot be taken for those of another exchange */

/* Variables that launchers set. A program without one runs alone, without a start of MPI. */
static int has_launcher(void)
{
  static const char *const names[] = {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK", "PMI_SIZE"};
  for (size_t i = 0; i < sizeof names / sizeof *names; i++)
    if (getenv(names[i])) return 1;
  return 0;
}

void keyway_start_ranks(void)
{
  int given;
  MPI_Comm here;
  if (is_started || !has_launcher()) return;
  MPI_Init_thread(NULL, NULL, MPI_THREAD_FUNNELED, &given);
  is_started = 1;
  MPI_Comm_size(MPI_COMM_WORLD, &number);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &here);
  MPI_Comm_size(here, &number_here);
  MPI_Comm_free(&here);
  MPI_Comm_dup(MPI_COMM_WORLD, &meetings);
}

int keyway_num_ranks(void) { return number; }
int keyway_num_ranks_here(void) { return number_here; }
int keyway_this_rank(void) { return rank; }

int keyway_is_alone(void) { return is_alone; }

/* 1 when all ranks have called this, 0 when the time is over (0: without end). */
int keyway_wait_for_ranks(int seconds)
{
  const struct timespec pause = {0, 200000};
  MPI_Request request;
  double start;
  int all_come = 0;
  if (number == 1 || is_alone) return !is_alone;
  MPI_Ibarrier(meetings, &request);
  start = MPI_Wtime();
  while (!all_come && !is_alone) {
    MPI_Test(&request, &all_come, MPI_STATUS_IGNORE);
    if (!all_come) nanosleep(&pause, NULL);
    is_alone = !all_come && seconds > 0 && MPI_Wtime() > start + seconds;
  }
  keyway_add_waiting(MPI_Wtime() - start);
  return all_come;
}

void keyway_end_ranks(int code)
{
  if (!is_started) return;
  if (is_alone) MPI_Abort(MPI_COMM_WORLD, code);
  MPI_Finalize();
  is_started = 0;
}

/* Rank 0 sums and sends the result, so that all ranks have the same bits. */
void keyway_add_over_ranks(double *x, size_t length)
{
  if (number == 1) return;
  while (length > 0) {
    const int count = length < (size_t)INT_MAX ? (int)length : INT_MAX;
    MPI_Reduce(rank == 0 ? MPI_IN_PLACE : x, x, count, MPI_DOUBLE, MPI_SUM, 0, MPI_COMM_WORLD);
    MPI_Bcast(x, count, MPI_DOUBLE, 0, MPI_COMM_WORLD);
    x += count;
    length -= (size_t)count;
  }
}

void keyway_gather_rows(const double *own, double *all, int num_ranks, const int *first)
{
  int *count = malloc((size_t)num_ranks * sizeof *count);
  if (!count) MPI_Abort(MPI_COMM_WORLD, 3);
  for (int i = 0; i < num_ranks; i++) count[i] = first[i + 1] - first[i];
  if (is_started) {
    MPI_Allgatherv(own, count[rank], MPI_DOUBLE, all, count, first, MPI_DOUBLE, MPI_COMM_WORLD);
  } else {
    for (int i = 0; i < first[1]; i++) all[i] = own[i];
  }
  free(count);
}

/* `first` counts on rank 0 alone, where it has the place of each rank's numbers in `all`. */
void keyway_gather_on_first_rank(const double *own, int length, double *all, int num_ranks,
                                 const int *first)
{
  int *count = malloc((size_t)num_ranks * sizeof *count);
  if (!count) MPI_Abort(MPI_COMM_WORLD, 3);
  for (int i = 0; i < num_ranks; i++) count[i] = first[i + 1] - first[i];
  if (number > 1)
    MPI_Gatherv(own, length, MPI_DOUBLE, all, count, first, MPI_DOUBLE, 0, MPI_COMM_WORLD);
  free(count);
}

void keyway_exchange(int num_neighbours, const int *neighbour, const int *first,
                     const double *sent, double *received)
{
  const int number_of_requests = 2 * num_neighbours;
  MPI_Request *request;
  if (num_neighbours == 0) return;
  request = malloc((size_t)number_of_requests * sizeof *request);
  if (!request) MPI_Abort(MPI_COMM_WORLD, 3);
  for (int i = 0; i < num_neighbours; i++) {
    const int count = first[i + 1] - first[i];
    MPI_Irecv(received + first[i], count, MPI_DOUBLE, neighbour[i], 0, MPI_COMM_WORLD, request + i);
    MPI_Isend(sent + first[i], count, MPI_DOUBLE, neighbour[i], 0, MPI_COMM_WORLD,
              request + num_neighbours + i);
  }
  MPI_Waitall(number_of_requests, request, MPI_STATUSES_IGNORE);
  free(request);
}

int keyway_least_of_ranks(int own)
{
  int least = own;
  if (number > 1) MPI_Allreduce(&own, &least, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD);
  return least;
}

void keyway_share_text(int from, char *text, int length)
{
  if (number > 1) MPI_Bcast(text, length, MPI_CHAR, from, MPI_COMM_WORLD);
}
