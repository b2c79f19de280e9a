/* PETSc's own conversion expects that the three rows of each node have the same columns; a
 * component that is prescribed has none. */
#include "block_matrix.h"

enum { width = 3 };

/* Blocks of the upper triangle in the rows of a node: own columns, columns of other ranks. */
static PetscErrorCode count_blocks(Mat rows, PetscInt node, PetscInt end, PetscInt *own,
                                   PetscInt *other)
{
  PetscInt *found, total = 0;
  PetscFunctionBegin;
  *own = *other = 0;
  for (PetscInt i = width * node; i < width * (node + 1); i++) {
    PetscInt count;
    PetscCall(MatGetRow(rows, i, &count, NULL, NULL));
    total += count;
    PetscCall(MatRestoreRow(rows, i, &count, NULL, NULL));
  }
  PetscCall(PetscMalloc1(total, &found));
  total = 0;
  for (PetscInt i = width * node; i < width * (node + 1); i++) {
    PetscInt count;
    const PetscInt *column;
    PetscCall(MatGetRow(rows, i, &count, &column, NULL));
    for (PetscInt k = 0; k < count; k++) found[total++] = column[k] / width;
    PetscCall(MatRestoreRow(rows, i, &count, &column, NULL));
  }
  PetscCall(PetscSortRemoveDupsInt(&total, found));
  for (PetscInt k = 0; k < total; k++) {
    if (found[k] < node) continue;
    if (found[k] < end) ++*own;
    else ++*other;
  }
  PetscCall(PetscFree(found));
  PetscFunctionReturn(0);
}

static PetscErrorCode make_blocks(Mat rows, Mat *blocks)
{
  PetscInt first, end, *own, *other;
  PetscFunctionBegin;
  PetscCall(MatGetOwnershipRange(rows, &first, &end));
  PetscCall(PetscMalloc2((end - first) / width, &own, (end - first) / width, &other));
  for (PetscInt node = first / width; node < end / width; node++) {
    const PetscInt k = node - first / width;
    PetscCall(count_blocks(rows, node, end / width, &own[k], &other[k]));
  }
  PetscCall(MatCreate(PetscObjectComm((PetscObject)rows), blocks));
  PetscCall(MatSetSizes(*blocks, end - first, end - first, PETSC_DETERMINE, PETSC_DETERMINE));
  PetscCall(MatSetType(*blocks, MATSBAIJ));
  PetscCall(MatXAIJSetPreallocation(*blocks, width, NULL, NULL, own, other));
  PetscCall(MatSetOption(*blocks, MAT_IGNORE_LOWER_TRIANGULAR, PETSC_TRUE));
  PetscCall(MatSetOption(*blocks, MAT_SPD, PETSC_TRUE));
  PetscCall(PetscFree2(own, other));
  PetscFunctionReturn(0);
}

PetscErrorCode copy_to_blocks(Mat rows, Mat *blocks)
{
  PetscInt first, end;
  PetscFunctionBegin;
  if (!*blocks) PetscCall(make_blocks(rows, blocks));
  else PetscCall(MatZeroEntries(*blocks));
  PetscCall(MatGetOwnershipRange(rows, &first, &end));
  for (PetscInt i = first; i < end; i++) {
    PetscInt count;
    const PetscInt *column;
    const PetscScalar *value;
    PetscCall(MatGetRow(rows, i, &count, &column, &value));
    PetscCall(MatSetValues(*blocks, 1, &i, count, column, value, INSERT_VALUES));
    PetscCall(MatRestoreRow(rows, i, &count, &column, &value));
  }
  PetscCall(MatAssemblyBegin(*blocks, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*blocks, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(0);
}
