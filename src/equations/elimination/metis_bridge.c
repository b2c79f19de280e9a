/* METIS behind plain numbers: order of elimination, parts of graphs and of meshes.
 *
 * METIS catches SIGTERM while it works and jumps out of what it does, also out of malloc, which
 * spoils the memory of the program. Therefore the threads hold the signal back during each call; the
 * program gets it afterwards. */
#include <metis.h>
#include <pthread.h>
#include <signal.h>
#include <stddef.h>
#include <stdlib.h>

_Static_assert(sizeof(idx_t) == sizeof(int), "METIS must be built with 32-bit indices");

/* The larger side of a separator may have this many thousandths more than half of the graph. With
 * METIS's own 200 separators are larger: dams are long, and have few places that are narrow
 * (docs/performance.md, "Order of elimination"). */
enum { unbalance = 400 };

/* Holds SIGTERM back in all threads (SIG_BLOCK), or lets it through (SIG_UNBLOCK). */
static void mask_signal(int how)
{
  sigset_t held;
  sigemptyset(&held);
  sigaddset(&held, SIGTERM);
#pragma omp parallel
  pthread_sigmask(how, &held, NULL);
}

/* Order of elimination of a graph (0-based adjacency without loops); order[new] = old.
 * Returns 0 for success. */
int keyway_nested_dissection(int n, int *start, int *neighbour, int *weight, int *order)
{
  idx_t options[METIS_NOPTIONS];
  int *place = malloc((size_t)n * sizeof *place);
  int status;
  if (!place) return 1;
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_NUMBERING] = 0;
  options[METIS_OPTION_UFACTOR] = unbalance;
  mask_signal(SIG_BLOCK);
  status = METIS_NodeND(&n, start, neighbour, weight, options, order, place);
  mask_signal(SIG_UNBLOCK);
  free(place);
  return status == METIS_OK ? 0 : 1;
}

/* Divides the nodes of a graph (as above, with weights of the edges) among parts of about the same
 * size; edges between parts have small weights. part[node] from 0. Returns 0 for success. Repeated
 * halving: METIS_PartGraphKway scatters parts of 32 nodes. */
int keyway_divide_graph(int num_nodes, int *start, int *neighbour, int *weight, int num_parts,
                        int *part)
{
  idx_t options[METIS_NOPTIONS], constraints = 1, cut;
  int status;
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_NUMBERING] = 0;
  mask_signal(SIG_BLOCK);
  status = METIS_PartGraphRecursive(&num_nodes, &constraints, start, neighbour, NULL, NULL, weight,
                                    &num_parts, NULL, NULL, options, &cut, part);
  mask_signal(SIG_UNBLOCK);
  return status == METIS_OK ? 0 : 1;
}

/* Elements that have a face in common. METIS allocates both lists. */
static int find_neighbours(int num_elements, int num_nodes, int *first, int *node, int **start,
                           int **neighbour)
{
  enum { nodes_of_face = 4 };
  idx_t common = nodes_of_face, from_zero = 0;
  int status;
  mask_signal(SIG_BLOCK);
  status = METIS_MeshToDual(&num_elements, &num_nodes, first, node, &common, &from_zero, start,
                            neighbour);
  mask_signal(SIG_UNBLOCK);
  return status == METIS_OK ? 0 : 1;
}

static double square_of_distance(const double *a, const double *b)
{
  double sum = 0;
  for (int i = 0; i < 3; i++) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum;
}

/* A face counts as much as it couples its elements: the stiffness of a brick between two of its
 * faces goes with 1 over the square of their distance, here over that of its farthest neighbour. */
static void weigh_faces(int num_elements, const int *start, const int *neighbour, const double *x,
                        double *farthest, int *weight)
{
  const double usual = 1000, most_of_mesh = 3e8; /* METIS adds integers */
  const double largest = num_elements * usual < most_of_mesh ? usual : most_of_mesh / num_elements;
  for (int e = 0; e < num_elements; e++) {
    farthest[e] = 0;
    for (int k = start[e]; k < start[e + 1]; k++) {
      const double square = square_of_distance(x + 3 * (size_t)e, x + 3 * (size_t)neighbour[k]);
      if (square > farthest[e]) farthest[e] = square;
    }
  }
  for (int e = 0; e < num_elements; e++) {
    for (int k = start[e]; k < start[e + 1]; k++) {
      const int other = neighbour[k];
      const double square = square_of_distance(x + 3 * (size_t)e, x + 3 * (size_t)other);
      const double far = farthest[e] > farthest[other] ? farthest[e] : farthest[other];
      weight[k] = far < largest * square ? (int)(far / square) : 1 + (int)largest;
    }
  }
}

/* Divides elements among parts of about the same size whose borders couple little; part[element]
 * from 0. x: centres of the elements. Returns 0 for success. */
int keyway_divide_mesh(int num_elements, int num_nodes, int *first, int *node, const double *x,
                       int num_parts, int *part)
{
  int *start = NULL, *neighbour = NULL, *weight = NULL, has_failed;
  double *farthest = malloc((size_t)num_elements * sizeof *farthest);
  has_failed = !farthest
               || find_neighbours(num_elements, num_nodes, first, node, &start, &neighbour);
  if (!has_failed) weight = malloc(((size_t)start[num_elements] + 1) * sizeof *weight);
  has_failed = has_failed || !weight;
  if (!has_failed) {
    weigh_faces(num_elements, start, neighbour, x, farthest, weight);
    has_failed = keyway_divide_graph(num_elements, start, neighbour, weight, num_parts, part);
  }
  METIS_Free(start);
  METIS_Free(neighbour);
  free(weight);
  free(farthest);
  return has_failed;
}
