/* Behind ranks.f90 in the plain program: one process. */
#include <stddef.h>
#include <string.h>

void keyway_start_ranks(void) {}
void keyway_end_ranks(int code) { (void)code; }
int keyway_num_ranks(void) { return 1; }
int keyway_num_ranks_here(void) { return 1; }
int keyway_this_rank(void) { return 0; }
double keyway_exchange_seconds(void) { return 0; }

int keyway_is_alone(void) { return 0; }

int keyway_wait_for_ranks(int seconds)
{
  (void)seconds;
  return 1;
}

void keyway_add_over_ranks(double *x, size_t length)
{
  (void)x;
  (void)length;
}

void keyway_gather_rows(const double *own, double *all, int num_ranks, const int *first)
{
  memcpy(all, own, (size_t)first[num_ranks] * sizeof *all);
}

void keyway_gather_on_first_rank(const double *own, int length, double *all, int num_ranks,
                                 const int *first)
{
  (void)num_ranks;
  memcpy(all + first[0], own, (size_t)length * sizeof *all);
}

void keyway_exchange(int num_neighbours, const int *neighbour, const int *first,
                     const double *sent, double *received)
{
  (void)num_neighbours;
  (void)neighbour;
  (void)first;
  (void)sent;
  (void)received;
}

int keyway_least_of_ranks(int number) { return number; }

void keyway_share_text(int rank, char *text, int length)
{
  (void)rank;
  (void)text;
  (void)length;
}
