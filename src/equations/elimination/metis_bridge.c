/* METIS's nested dissection behind plain integers.
 *
 * METIS catches SIGTERM while it works, gives up and returns METIS_ERROR. Each function below then
 * asks METIS once more. If METIS now succeeds, a signal has stopped it, and the program gets the
 * signal afterwards. */
#include <metis.h>
#include <signal.h>
#include <stddef.h>
#include <stdlib.h>

_Static_assert(sizeof(idx_t) == sizeof(int), "METIS must be built with 32-bit indices");

/* The larger side of a separator may have this many thousandths more than half of the graph. With
 * METIS's own 200 separators are larger: dams are long, and have few places that are narrow
 * (docs/performance.md, "Order of elimination"). */
enum { unbalance = 400 };

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
  status = METIS_NodeND(&n, start, neighbour, weight, options, order, place);
  if (status == METIS_ERROR) {
    status = METIS_NodeND(&n, start, neighbour, weight, options, order, place);
    if (status == METIS_OK) raise(SIGTERM);
  }
  free(place);
  return status == METIS_OK ? 0 : 1;
}

/* Divides elements among parts of about the same weight with few nodes on borders; part[element]
 * from 0. Elements are neighbours where they have a face in common. Returns 0 for success. */
int keyway_divide_mesh(int num_elements, int num_nodes, int *first, int *node, int *weight,
                       int num_parts, int *part)
{
  enum { nodes_of_face = 4 };
  idx_t options[METIS_NOPTIONS], common = nodes_of_face, cut;
  int *part_of_node = malloc((size_t)num_nodes * sizeof *part_of_node);
  int status;
  if (!part_of_node) return 1;
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_NUMBERING] = 0;
  status = METIS_PartMeshDual(&num_elements, &num_nodes, first, node, weight, NULL, &common,
                              &num_parts, NULL, options, &cut, part, part_of_node);
  if (status == METIS_ERROR) {
    status = METIS_PartMeshDual(&num_elements, &num_nodes, first, node, weight, NULL, &common,
                                &num_parts, NULL, options, &cut, part, part_of_node);
    if (status == METIS_OK) raise(SIGTERM);
  }
  free(part_of_node);
  return status == METIS_OK ? 0 : 1;
}
