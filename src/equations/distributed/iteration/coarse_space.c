/* R. A. Nicolaides, SIAM Journal on Numerical Analysis 24, 1987, 355-365; rigid bodies: T. B.
 * Jonsthovel, M. B. van Gijzen, S. MacLachlan, C. Vuik, A. Scarpas, Computational Mechanics 50,
 * 2012, 321-333. */
#include "coarse_space.h"

#include "../block_matrix.h"
#include "node_groups.h"

enum { width = 3 };

/* Nodes of a group. Of a dam, 64 take 0.85 to 0.9 times as many iterations, each 1.1 times as long;
 * 512 take 1.5 to 1.8 times as many (docs/large_models.md, 4). */
enum { nodes_of_group = 128 };

/* Most groups of all ranks: each rank solves for the motions of all groups. */
enum { most_groups = 4000 };

/* Entries of A W over those of A and W: some 17 over 84 in a row. PETSc takes more memory where they
 * are more. */
static const double fill = 0.3;

/* A motion of a group that others give but for this part: nodes on a line, or a single node. */
static const double dependent = 1e-8;

PetscErrorCode keep_rigid_motions(struct coarse_space *self, int rows, const double *rigid)
{
  PetscFunctionBegin;
  PetscCall(PetscMalloc1((size_t)num_rigid * rows, &self->rigid));
  PetscCall(PetscArraycpy(self->rigid, rigid, (size_t)num_rigid * rows));
  PetscFunctionReturn(0);
}

static PetscErrorCode count_groups(Mat rows, int *count)
{
  PetscInt own, all;
  PetscFunctionBegin;
  PetscCall(MatGetLocalSize(rows, &own, NULL));
  PetscCall(MatGetSize(rows, &all, NULL));
  const double size = PetscMax(nodes_of_group, (double)all / width / most_groups);
  *count = own == 0 ? 0 : PetscMax(1, (int)(own / width / size + 0.5));
  PetscFunctionReturn(0);
}

/* The nodes group by group: those of group g are node[first[g]] to node[first[g + 1] - 1]. */
static PetscErrorCode list_nodes(int nodes, int groups, const int *group_of_node, int *first,
                                 int *node)
{
  int *next;
  PetscFunctionBegin;
  PetscCall(PetscMalloc1(groups, &next));
  for (int g = 0; g <= groups; g++) first[g] = 0;
  for (int i = 0; i < nodes; i++) first[group_of_node[i] + 1]++;
  for (int g = 0; g < groups; g++) first[g + 1] += first[g];
  for (int g = 0; g < groups; g++) next[g] = first[g];
  for (int i = 0; i < nodes; i++) node[next[group_of_node[i]]++] = i;
  PetscCall(PetscFree(next));
  PetscFunctionReturn(0);
}

/* Orthonormal motions of a group, by Gram and Schmidt, twice. A motion that depends on others is
 * zero. */
static void find_motions(int count, const int *node, int rows, const double *rigid, double *motion)
{
  const int length = width * count;
  for (int k = 0; k < num_rigid; k++) {
    double *now = motion + (size_t)k * length, before = 0, after = 0;
    for (int i = 0; i < length; i++)
      now[i] = rigid[(size_t)k * rows + width * node[i / width] + i % width];
    for (int i = 0; i < length; i++) before += now[i] * now[i];
    for (int m = 0; m < 2 * k; m++) {
      const double *other = motion + (size_t)(m % k) * length;
      double product = 0;
      for (int i = 0; i < length; i++) product += now[i] * other[i];
      for (int i = 0; i < length; i++) now[i] -= product * other[i];
    }
    for (int i = 0; i < length; i++) after += now[i] * now[i];
    const double scale = after > dependent * dependent * before ? 1 / PetscSqrtReal(after) : 0;
    for (int i = 0; i < length; i++) now[i] *= scale;
  }
}

/* Puts the motions of a group into its six columns. */
static PetscErrorCode insert_motions(Mat motions, int group, int count, const int *node,
                                     const double *motion)
{
  const int length = width * count;
  PetscInt first_row, first_column;
  PetscFunctionBegin;
  PetscCall(MatGetOwnershipRange(motions, &first_row, NULL));
  PetscCall(MatGetOwnershipRangeColumn(motions, &first_column, NULL));
  for (int i = 0; i < length; i++) {
    const PetscInt row = first_row + width * node[i / width] + i % width;
    PetscInt column[num_rigid];
    PetscScalar value[num_rigid];
    for (int k = 0; k < num_rigid; k++) {
      column[k] = first_column + num_rigid * group + k;
      value[k] = motion[(size_t)k * length + i];
    }
    PetscCall(MatSetValues(motions, 1, &row, num_rigid, column, value, INSERT_VALUES));
  }
  PetscFunctionReturn(0);
}

static PetscErrorCode fill_motions(Mat motions, int rows, int groups, const int *group_of_node,
                                   const double *rigid)
{
  const int nodes = rows / width;
  int *first, *node, most = 0;
  double *motion;
  PetscFunctionBegin;
  PetscCall(PetscMalloc2(groups + 1, &first, nodes, &node));
  PetscCall(list_nodes(nodes, groups, group_of_node, first, node));
  for (int g = 0; g < groups; g++) most = PetscMax(most, first[g + 1] - first[g]);
  PetscCall(PetscMalloc1((size_t)num_rigid * width * most, &motion));
  for (int g = 0; g < groups; g++) {
    const int count = first[g + 1] - first[g];
    find_motions(count, node + first[g], rows, rigid, motion);
    PetscCall(insert_motions(motions, g, count, node + first[g], motion));
  }
  PetscCall(PetscFree(motion));
  PetscCall(PetscFree2(first, node));
  PetscCall(MatAssemblyBegin(motions, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(motions, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(0);
}

/* Groups by the couplings of the matrix, and their motions. */
static PetscErrorCode make_motions(struct coarse_space *self, Mat rows)
{
  PetscInt own;
  int groups = 0, *group_of_node;
  PetscFunctionBegin;
  PetscCall(MatGetLocalSize(rows, &own, NULL));
  PetscCall(count_groups(rows, &groups));
  PetscCall(find_node_groups(rows, groups, &group_of_node));
  PetscCall(MatCreateAIJ(PetscObjectComm((PetscObject)rows), own, num_rigid * groups,
                         PETSC_DETERMINE, PETSC_DETERMINE, num_rigid, NULL, 0, NULL,
                         &self->motions));
  PetscCall(fill_motions(self->motions, own, groups, group_of_node, self->rigid));
  PetscCall(PetscFree(group_of_node));
  PetscCall(PetscFree(self->rigid));
  PetscCall(MatCreateVecs(self->motions, &self->load, NULL));
  PetscCall(VecDuplicate(self->load, &self->answer));
  PetscFunctionReturn(0);
}

/* A motion that is zero gets an equation of its own. */
static PetscErrorCode fill_empty_rows(Mat coarse)
{
  Vec diagonal;
  const PetscScalar *own;
  PetscInt first, end;
  PetscFunctionBegin;
  PetscCall(MatCreateVecs(coarse, &diagonal, NULL));
  PetscCall(MatGetDiagonal(coarse, diagonal));
  PetscCall(VecGetOwnershipRange(diagonal, &first, &end));
  PetscCall(VecGetArrayRead(diagonal, &own));
  for (PetscInt i = first; i < end; i++)
    if (own[i - first] == 0) PetscCall(MatSetValue(coarse, i, i, 1, INSERT_VALUES));
  PetscCall(VecRestoreArrayRead(diagonal, &own));
  PetscCall(VecDestroy(&diagonal));
  PetscCall(MatAssemblyBegin(coarse, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(coarse, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(0);
}

/* Each rank factors the whole matrix of the motions: an iteration then sends one vector. */
static PetscErrorCode factor_coarse(struct coarse_space *self, Mat coarse, int *is_definite)
{
  PC pc, inner;
  KSP solver;
  PCFailedReason reason;
  PetscFunctionBegin;
  PetscCall(KSPCreate(PetscObjectComm((PetscObject)coarse), &self->solver));
  PetscCall(KSPSetType(self->solver, KSPPREONLY));
  PetscCall(KSPSetOperators(self->solver, coarse, coarse));
  PetscCall(KSPGetPC(self->solver, &pc));
  PetscCall(PCSetType(pc, PCREDUNDANT));
  PetscCall(PCRedundantGetKSP(pc, &solver));
  PetscCall(KSPGetPC(solver, &inner));
  PetscCall(PCSetType(inner, PCCHOLESKY));
  PetscCall(PCFactorSetMatSolverType(inner, MATSOLVERMUMPS));
  PetscCall(KSPSetUp(self->solver));
  PetscCall(PCGetFailedReason(inner, &reason));
  *is_definite = !reason;
  PetscFunctionReturn(0);
}

/* A W and W^T A W. PETSc multiplies no blocks with W, and keeps the factors of a product. */
static PetscErrorCode multiply_motions(struct coarse_space *self, Mat blocks, Mat *coarse)
{
  Mat rows;
  PetscFunctionBegin;
  PetscCall(copy_to_rows(blocks, &rows));
  if (!self->motions) PetscCall(make_motions(self, rows));
  PetscCall(MatMatMult(rows, self->motions, MAT_INITIAL_MATRIX, fill, &self->forces));
  PetscCall(MatProductClear(self->forces));
  PetscCall(MatDestroy(&rows));
  PetscCall(MatTransposeMatMult(self->motions, self->forces, MAT_INITIAL_MATRIX, PETSC_DEFAULT,
                                coarse));
  PetscFunctionReturn(0);
}

PetscErrorCode set_up_coarse(struct coarse_space *self, Mat blocks, int *is_definite)
{
  Mat coarse;
  PetscFunctionBegin;
  PetscCall(KSPDestroy(&self->solver));
  PetscCall(MatDestroy(&self->forces));
  PetscCall(multiply_motions(self, blocks, &coarse));
  PetscCall(MatSetOption(coarse, MAT_SPD, PETSC_TRUE));
  PetscCall(fill_empty_rows(coarse));
  PetscCall(factor_coarse(self, coarse, is_definite));
  PetscCall(MatDestroy(&coarse));
  PetscFunctionReturn(0);
}

PetscErrorCode add_coarse_solution(struct coarse_space *self, Vec r, Vec x)
{
  PetscFunctionBegin;
  PetscCall(MatMultTranspose(self->motions, r, self->load));
  PetscCall(KSPSolve(self->solver, self->load, self->answer));
  PetscCall(MatMultAdd(self->motions, self->answer, x, x));
  PetscFunctionReturn(0);
}

PetscErrorCode correct_coarse(struct coarse_space *self, Vec r, Vec z)
{
  PetscFunctionBegin;
  PetscCall(MatMultTranspose(self->forces, z, self->load));
  PetscCall(VecScale(self->load, -1));
  PetscCall(MatMultTransposeAdd(self->motions, r, self->load, self->load));
  PetscCall(KSPSolve(self->solver, self->load, self->answer));
  PetscCall(MatMultAdd(self->motions, self->answer, z, z));
  PetscFunctionReturn(0);
}

PetscErrorCode forget_coarse(struct coarse_space *self)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(self->rigid));
  PetscCall(MatDestroy(&self->motions));
  PetscCall(MatDestroy(&self->forces));
  PetscCall(KSPDestroy(&self->solver));
  PetscCall(VecDestroy(&self->load));
  PetscCall(VecDestroy(&self->answer));
  PetscFunctionReturn(0);
}
