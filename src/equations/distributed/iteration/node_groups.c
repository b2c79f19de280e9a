/* METIS cuts where couplings are weak: groups of stretched bricks are wide where the bricks are
 * long, and each group moves nearly as a rigid body. */
#include "node_groups.h"

enum { width = 3 };

/* Weight of a coupling as stiff as the diagonals, and the most that all nodes may add up to: METIS
 * takes integers. Couplings are squared: of bricks of 1 : 3 the short edges count 81 times as much
 * as the long ones. */
static const double largest_weight = 4000, most_of_graph = 5e8;

int keyway_divide_graph(int num_nodes, int *start, int *neighbour, int *weight, int num_parts,
                        int *part);

/* Nodes from 0; an edge stands at both of its nodes. */
struct graph {
  int nodes, *start, *neighbour, *weight;
};

/* Couplings of a node with nodes after it on this rank. */
struct couplings {
  int count, *other; /* the others */
  double *square;    /* (all nodes) sum of the squares of nine entries; 0 between calls */
  double own;        /* the same for the node itself */
};

static PetscErrorCode read_couplings(Mat rows, PetscInt node, struct couplings *found)
{
  PetscInt first, end;
  PetscFunctionBegin;
  PetscCall(MatGetOwnershipRange(rows, &first, &end));
  found->count = 0;
  found->own = 0;
  for (PetscInt i = first + width * node; i < first + width * (node + 1); i++) {
    PetscInt count;
    const PetscInt *column;
    const PetscScalar *value;
    PetscCall(MatGetRow(rows, i, &count, &column, &value));
    for (PetscInt k = 0; k < count; k++) {
      const PetscInt other = (column[k] - first) / width;
      const double square = value[k] * value[k];
      if (column[k] < first || column[k] >= end || other < node || square == 0) continue;
      if (other == node) {
        found->own += square;
      } else {
        if (found->square[other] == 0) found->other[found->count++] = other;
        found->square[other] += square;
      }
    }
    PetscCall(MatRestoreRow(rows, i, &count, &column, &value));
  }
  PetscFunctionReturn(0);
}

/* Numbers of edges, and `own` of each node. */
static PetscErrorCode count_edges(Mat rows, struct couplings *found, struct graph *self,
                                  double *own)
{
  PetscFunctionBegin;
  for (int i = 0; i <= self->nodes; i++) self->start[i] = 0;
  for (int i = 0; i < self->nodes; i++) {
    PetscCall(read_couplings(rows, i, found));
    own[i] = found->own;
    self->start[i + 1] += found->count;
    for (int k = 0; k < found->count; k++) {
      self->start[found->other[k] + 1]++;
      found->square[found->other[k]] = 0;
    }
  }
  for (int i = 0; i < self->nodes; i++) self->start[i + 1] += self->start[i];
  PetscFunctionReturn(0);
}

static void add_edge(const struct graph *self, int *next, int from, int to, int weight)
{
  self->neighbour[next[from]] = to;
  self->weight[next[from]++] = weight;
}

static PetscErrorCode fill_edges(Mat rows, struct couplings *found, const double *own, int *next,
                                 struct graph *self)
{
  const double largest = PetscMin(largest_weight, most_of_graph / self->nodes);
  PetscFunctionBegin;
  for (int i = 0; i < self->nodes; i++) next[i] = self->start[i];
  for (int i = 0; i < self->nodes; i++) {
    PetscCall(read_couplings(rows, i, found));
    for (int k = 0; k < found->count; k++) {
      const int j = found->other[k];
      const double part = found->square[j] / PetscSqrtReal(own[i] * own[j]);
      const int weight = 1 + (int)(largest * PetscMin(part, 1));
      add_edge(self, next, i, j, weight);
      add_edge(self, next, j, i, weight);
      found->square[j] = 0;
    }
  }
  PetscFunctionReturn(0);
}

static PetscErrorCode build_graph(Mat rows, struct graph *self)
{
  struct couplings found;
  double *own;
  int *next;
  PetscFunctionBegin;
  PetscCall(PetscMalloc3(self->nodes, &own, self->nodes, &found.other, self->nodes, &next));
  PetscCall(PetscCalloc1(self->nodes, &found.square));
  PetscCall(PetscMalloc1(self->nodes + 1, &self->start));
  PetscCall(count_edges(rows, &found, self, own));
  PetscCall(PetscMalloc2(self->start[self->nodes], &self->neighbour, self->start[self->nodes],
                         &self->weight));
  PetscCall(fill_edges(rows, &found, own, next, self));
  PetscCall(PetscFree3(own, found.other, next));
  PetscCall(PetscFree(found.square));
  PetscFunctionReturn(0);
}

PetscErrorCode find_node_groups(Mat rows, int count, int **group_of_node)
{
  struct graph graph;
  PetscInt own;
  int has_failed = 0;
  PetscFunctionBegin;
  PetscCall(MatGetLocalSize(rows, &own, NULL));
  graph.nodes = own / width;
  PetscCall(PetscCalloc1(graph.nodes, group_of_node));
  if (count < 2) PetscFunctionReturn(0);
  PetscCall(build_graph(rows, &graph));
  has_failed = keyway_divide_graph(graph.nodes, graph.start, graph.neighbour, graph.weight, count,
                                   *group_of_node);
  PetscCall(PetscFree(graph.start));
  PetscCall(PetscFree2(graph.neighbour, graph.weight));
  PetscFunctionReturn(has_failed ? PETSC_ERR_LIB : 0);
}
