#include "block_matrix.h"

enum { width = 3, size = width * width };

/* Two numbers for each row of blocks: blocks in columns of its rank, and of other ranks. */
static PetscErrorCode open_counts(int rows, Vec *counts)
{
  PetscFunctionBegin;
  PetscCall(VecCreateMPI(PETSC_COMM_WORLD, 2 * (rows / width), PETSC_DETERMINE, counts));
  PetscFunctionReturn(0);
}

static PetscErrorCode count_block(Vec counts, PetscInt row, PetscInt column)
{
  PetscLayout layout;
  const PetscInt *first;
  PetscMPIInt owner;
  PetscFunctionBegin;
  PetscCall(VecGetLayout(counts, &layout));
  PetscCall(PetscLayoutGetRanges(layout, &first));
  PetscCall(PetscLayoutFindOwner(layout, 2 * row, &owner));
  const int is_other = 2 * column < first[owner] || 2 * column >= first[owner + 1];
  PetscCall(VecSetValue(counts, 2 * row + is_other, 1, ADD_VALUES));
  PetscFunctionReturn(0);
}

/* The numbers of the own rows, for the caller to free. Ranks may have counted the same blocks: the
 * numbers are large enough, and no larger than a row. */
static PetscErrorCode close_counts(Vec *counts, PetscInt **own, PetscInt **other)
{
  PetscInt count, all;
  const PetscScalar *both;
  PetscFunctionBegin;
  PetscCall(VecAssemblyBegin(*counts));
  PetscCall(VecAssemblyEnd(*counts));
  PetscCall(VecGetLocalSize(*counts, &count));
  PetscCall(VecGetSize(*counts, &all));
  PetscCall(PetscMalloc2(count / 2, own, count / 2, other));
  PetscCall(VecGetArrayRead(*counts, &both));
  for (PetscInt k = 0; k < count / 2; k++) {
    (*own)[k] = PetscMin((PetscInt)both[2 * k], count / 2);
    (*other)[k] = PetscMin((PetscInt)both[2 * k + 1], (all - count) / 2);
  }
  PetscCall(VecRestoreArrayRead(*counts, &both));
  PetscCall(VecDestroy(counts));
  PetscFunctionReturn(0);
}

static PetscErrorCode open_matrix(int rows, MatType type, Mat *matrix)
{
  PetscFunctionBegin;
  PetscCall(MatCreate(PETSC_COMM_WORLD, matrix));
  PetscCall(MatSetSizes(*matrix, rows, rows, PETSC_DETERMINE, PETSC_DETERMINE));
  PetscCall(MatSetType(*matrix, type));
  PetscFunctionReturn(0);
}

PetscErrorCode plan_blocks(int rows, const struct block_list *list, Mat *blocks)
{
  Vec counts;
  PetscInt *own, *other;
  PetscFunctionBegin;
  PetscCall(open_counts(rows, &counts));
  for (int k = 0; k < list->count; k++)
    PetscCall(count_block(counts, list->row[k], list->column[k]));
  PetscCall(close_counts(&counts, &own, &other));
  PetscCall(open_matrix(rows, MATSBAIJ, blocks));
  PetscCall(MatXAIJSetPreallocation(*blocks, width, NULL, NULL, own, other));
  PetscCall(PetscFree2(own, other));
  PetscCall(MatSetOption(*blocks, MAT_NO_OFF_PROC_ENTRIES, PETSC_TRUE));
  PetscCall(MatSetOption(*blocks, MAT_SPD, PETSC_TRUE));
  PetscFunctionReturn(0);
}

PetscErrorCode sum_blocks(const struct block_list *list, const double *values, Mat blocks)
{
  double *others;
  PetscFunctionBegin;
  PetscCall(exchange_values(list, values, &others));
  PetscCall(MatZeroEntries(blocks));
  for (int k = 0; k < list->count; k++)
    if (is_own_block(list, list->row[k]))
      PetscCall(MatSetValuesBlocked(blocks, 1, &list->row[k], 1, &list->column[k],
                                    values + (size_t)size * k, ADD_VALUES));
  for (int k = 0; k < list->num_others; k++)
    PetscCall(MatSetValuesBlocked(blocks, 1, &list->others_row[k], 1, &list->others_column[k],
                                  others + (size_t)size * k, ADD_VALUES));
  PetscCall(PetscFree(others));
  PetscCall(MatAssemblyBegin(blocks, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(blocks, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(0);
}

/* Numbers of blocks in both triangles. */
static PetscErrorCode count_both(Mat blocks, PetscInt **own, PetscInt **other)
{
  Vec counts;
  PetscInt first, end;
  PetscFunctionBegin;
  PetscCall(MatGetOwnershipRange(blocks, &first, &end));
  PetscCall(open_counts(end - first, &counts));
  for (PetscInt i = first; i < end; i += width) {
    PetscInt count;
    const PetscInt *column;
    PetscCall(MatGetRow(blocks, i, &count, &column, NULL));
    for (PetscInt k = 0; k < count; k += width) {
      PetscCall(count_block(counts, i / width, column[k] / width));
      if (column[k] > i) PetscCall(count_block(counts, column[k] / width, i / width));
    }
    PetscCall(MatRestoreRow(blocks, i, &count, &column, NULL));
  }
  PetscCall(close_counts(&counts, own, other));
  PetscFunctionReturn(0);
}

/* Copies a row of the upper triangle, and as a column what is right of its block on the diagonal. */
static PetscErrorCode copy_row(Mat blocks, PetscInt row, Mat rows)
{
  PetscInt count, right = 0;
  const PetscInt *column;
  const PetscScalar *value;
  PetscFunctionBegin;
  PetscCall(MatGetRow(blocks, row, &count, &column, &value));
  PetscCall(MatSetValues(rows, 1, &row, count, column, value, INSERT_VALUES));
  while (right < count && column[right] / width == row / width) right++;
  PetscCall(MatSetValues(rows, count - right, column + right, 1, &row, value + right,
                         INSERT_VALUES));
  PetscCall(MatRestoreRow(blocks, row, &count, &column, &value));
  PetscFunctionReturn(0);
}

PetscErrorCode copy_to_rows(Mat blocks, Mat *rows)
{
  PetscInt first, end, *own, *other;
  PetscFunctionBegin;
  PetscCall(MatGetRowUpperTriangular(blocks));
  PetscCall(count_both(blocks, &own, &other));
  PetscCall(MatGetOwnershipRange(blocks, &first, &end));
  PetscCall(open_matrix(end - first, MATAIJ, rows));
  PetscCall(MatXAIJSetPreallocation(*rows, width, own, other, NULL, NULL));
  PetscCall(PetscFree2(own, other));
  for (PetscInt i = first; i < end; i++) PetscCall(copy_row(blocks, i, *rows));
  PetscCall(MatRestoreRowUpperTriangular(blocks));
  PetscCall(MatAssemblyBegin(*rows, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*rows, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(0);
}
