/* METIS's nested dissection behind plain integers. */
#include <metis.h>
#include <stddef.h>
#include <stdlib.h>

_Static_assert(sizeof(idx_t) == sizeof(int), "METIS must be built with 32-bit indices");

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
  status = METIS_NodeND(&n, start, neighbour, weight, options, order, place);
  free(place);
  return status == METIS_OK ? 0 : 1;
}
