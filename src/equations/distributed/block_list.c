#include "block_list.h"

enum { width = 3, values_of_block = width * width };

int is_own_block(const struct block_list *list, int row)
{
  return row >= list->layout->rstart && row < list->layout->rend;
}

static PetscErrorCode copy_places(size_t count, const int *row, const int *column,
                                  struct block_list *list)
{
  PetscFunctionBegin;
  list->count = (int)count;
  PetscCall(PetscMalloc2(count, &list->row, count, &list->column));
  PetscCall(PetscArraycpy(list->row, row, count));
  PetscCall(PetscArraycpy(list->column, column, count));
  PetscFunctionReturn(0);
}

/* Numbers of blocks to and from each rank, as the first one of each. */
static PetscErrorCode count_blocks(struct block_list *list, int ranks)
{
  PetscMPIInt owner;
  PetscFunctionBegin;
  PetscCall(PetscCalloc2(ranks + 1, &list->sent, ranks + 1, &list->received));
  for (int k = 0; k < list->count; k++) {
    if (is_own_block(list, list->row[k])) continue;
    PetscCall(PetscLayoutFindOwner(list->layout, list->row[k], &owner));
    list->sent[owner + 1]++;
  }
  PetscCallMPI(MPI_Alltoall(list->sent + 1, 1, MPI_INT, list->received + 1, 1, MPI_INT,
                            list->layout->comm));
  for (int r = 0; r < ranks; r++) {
    list->sent[r + 1] += list->sent[r];
    list->received[r + 1] += list->received[r];
  }
  list->num_others = list->received[ranks];
  PetscFunctionReturn(0);
}

/* The blocks in foreign rows, rank by rank. */
static PetscErrorCode list_foreign(struct block_list *list, int ranks)
{
  PetscMPIInt owner;
  int *next;
  PetscFunctionBegin;
  PetscCall(PetscMalloc1(list->sent[ranks], &list->foreign));
  PetscCall(PetscMalloc1(ranks, &next));
  PetscCall(PetscArraycpy(next, list->sent, ranks));
  for (int k = 0; k < list->count; k++) {
    if (is_own_block(list, list->row[k])) continue;
    PetscCall(PetscLayoutFindOwner(list->layout, list->row[k], &owner));
    list->foreign[next[owner]++] = k;
  }
  PetscCall(PetscFree(next));
  PetscFunctionReturn(0);
}

/* Some numbers for each block, from rank to rank. */
static PetscErrorCode exchange(const struct block_list *list, int length, MPI_Datatype type,
                               const void *sent, void *received)
{
  int ranks, *size;
  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(list->layout->comm, &ranks));
  PetscCall(PetscMalloc1(4 * ranks, &size));
  for (int r = 0; r < ranks; r++) {
    size[r] = length * (list->sent[r + 1] - list->sent[r]);
    size[ranks + r] = length * list->sent[r];
    size[2 * ranks + r] = length * (list->received[r + 1] - list->received[r]);
    size[3 * ranks + r] = length * list->received[r];
  }
  PetscCallMPI(MPI_Alltoallv(sent, size, size + ranks, type, received, size + 2 * ranks,
                             size + 3 * ranks, type, list->layout->comm));
  PetscCall(PetscFree(size));
  PetscFunctionReturn(0);
}

static PetscErrorCode exchange_places(struct block_list *list, int ranks, const int *place,
                                      int **others)
{
  const int count = list->sent[ranks];
  int *sent;
  PetscFunctionBegin;
  PetscCall(PetscMalloc1(count, &sent));
  PetscCall(PetscMalloc1(list->num_others, others));
  for (int k = 0; k < count; k++) sent[k] = place[list->foreign[k]];
  PetscCall(exchange(list, 1, MPI_INT, sent, *others));
  PetscCall(PetscFree(sent));
  PetscFunctionReturn(0);
}

PetscErrorCode make_list(int rows, size_t count, const int *row, const int *column,
                         struct block_list *list)
{
  int ranks;
  PetscFunctionBegin;
  PetscCall(PetscLayoutCreateFromSizes(PETSC_COMM_WORLD, rows / width, PETSC_DETERMINE, 1,
                                       &list->layout));
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &ranks));
  PetscCall(copy_places(count, row, column, list));
  PetscCall(count_blocks(list, ranks));
  PetscCall(list_foreign(list, ranks));
  PetscCall(exchange_places(list, ranks, list->row, &list->others_row));
  PetscCall(exchange_places(list, ranks, list->column, &list->others_column));
  PetscFunctionReturn(0);
}

PetscErrorCode exchange_values(const struct block_list *list, const double *values,
                               double **others)
{
  int ranks, count;
  double *sent;
  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(list->layout->comm, &ranks));
  count = list->sent[ranks];
  PetscCall(PetscMalloc1((size_t)values_of_block * count, &sent));
  PetscCall(PetscMalloc1((size_t)values_of_block * list->num_others, others));
  for (int k = 0; k < count; k++)
    PetscCall(PetscArraycpy(sent + (size_t)values_of_block * k,
                            values + (size_t)values_of_block * list->foreign[k],
                            values_of_block));
  PetscCall(exchange(list, values_of_block, MPI_DOUBLE, sent, *others));
  PetscCall(PetscFree(sent));
  PetscFunctionReturn(0);
}

PetscErrorCode forget_list(struct block_list *list)
{
  PetscFunctionBegin;
  PetscCall(PetscFree2(list->row, list->column));
  PetscCall(PetscFree2(list->sent, list->received));
  PetscCall(PetscFree(list->foreign));
  PetscCall(PetscFree(list->others_row));
  PetscCall(PetscFree(list->others_column));
  PetscCall(PetscLayoutDestroy(&list->layout));
  PetscFunctionReturn(0);
}
