/* Blocks of 3 x 3 that ranks add to a matrix, sent to the ranks of their rows. */
#ifndef KEYWAY_BLOCK_LIST_H
#define KEYWAY_BLOCK_LIST_H
#include <petscvec.h>

/* The same block may stand there several times. */
struct block_list {
  int count, *row, *column; /* blocks that this rank adds, of any rank's rows, from 0 */
  int *foreign;             /* of them those in rows of other ranks, rank by rank */
  int num_others, *others_row, *others_column; /* that others add to own rows, rank by rank */
  int *sent, *received;     /* (ranks + 1) first block to and from each rank */
  PetscLayout layout;       /* rows of blocks of each rank; NULL before the list is made */
};

/* `rows` are the own rows of the matrix, three of a block. All ranks call it. */
PetscErrorCode make_list(int rows, size_t count, const int *row, const int *column,
                         struct block_list *list);

/* Whether a block stands in an own row. */
int is_own_block(const struct block_list *list, int row);

/* Sends nine values of each block in foreign rows, and returns those of others for own rows, for
 * the caller to free. All ranks call it. */
PetscErrorCode exchange_values(const struct block_list *list, const double *values,
                               double **others);

PetscErrorCode forget_list(struct block_list *list);
#endif
