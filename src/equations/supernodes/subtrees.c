#include "subtrees.h"
#include <omp.h>
#include <stdlib.h>
#include <string.h>

/* Trees are chosen for so many threads, however many there are: sums do not depend on their number.
 */
enum { planned_threads = 4 };
/* Time with trees over that of one thread, for which they are worth their sums. */
static const double largest_share = 0.9;
/* Values of a part of the factor that are worth waking threads up: 3 MB. */
static const double worth_threads = 4.0e5;
/* More trees are too small to be taken one by one. */
static const int most_trees = 4096;

/* A subtree that threads may take. */
struct candidate {
  double work;
  int root;
};

/* The elimination tree while subtrees are chosen. */
struct tree {
  int num_supernodes;
  int *parent;  /* (supernodes) num_supernodes for a root */
  int *first;   /* (supernodes) the least descendant, or itself */
  int *count;   /* (supernodes) of the subtree */
  double *work; /* (supernodes) values of the subtree */
};

static int width_of(const struct keyway_supernodes *l, int s)
{
  return l->column[s + 1] - l->column[s];
}

static int length_of(const struct keyway_supernodes *l, int s)
{
  return l->row_start[s + 1] - l->row_start[s];
}

/* Values that are read, without the upper triangle. */
static double own_work(const struct keyway_supernodes *l, int s)
{
  double width = width_of(l, s);
  return width * (length_of(l, s) - 0.5 * width);
}

static void free_tree(struct tree *t)
{
  free(t->parent);
  free(t->first);
  free(t->count);
  free(t->work);
}

/* Returns 0 for success. */
static int make_tree(const struct keyway_supernodes *l, struct tree *t)
{
  int n = l->column[l->num_supernodes], m = l->num_supernodes;
  size_t room = (size_t)m + 1;
  int *owner = malloc(((size_t)n + 1) * sizeof *owner);
  t->num_supernodes = m;
  t->parent = malloc(room * sizeof(int));
  t->first = malloc(room * sizeof(int));
  t->count = calloc(room, sizeof(int));
  t->work = calloc(room, sizeof(double));
  if (!owner || !t->parent || !t->first || !t->count || !t->work) {
    free(owner);
    return -2;
  }
  for (int s = 0; s < m; s++) {
    t->first[s] = s;
    for (int k = l->column[s]; k < l->column[s + 1]; k++) owner[k] = s;
  }
  for (int s = 0; s < m; s++) {
    int width = width_of(l, s), p = m;
    if (length_of(l, s) > width) p = owner[l->row[l->row_start[s] + width]];
    t->parent[s] = p;
    t->count[s]++;
    t->work[s] += own_work(l, s);
    t->count[p] += t->count[s];
    t->work[p] += t->work[s];
    if (p < m && t->first[s] < t->first[p]) t->first[p] = t->first[s];
  }
  free(owner);
  return 0;
}

/* Whether a subtree is a range of supernodes. */
static int is_range(const struct tree *t, int s) { return s - t->first[s] + 1 == t->count[s]; }

/* The largest tree first, trees of equal work in the order of their roots. */
static int compare(const void *a, const void *b)
{
  const struct candidate *x = a, *y = b;
  if (x->work > y->work) return -1;
  if (x->work < y->work) return 1;
  return (x->root > y->root) - (x->root < y->root);
}

/* Adds the subtrees below a supernode, or all trees, and sorts the list. */
static void add_children(const struct tree *t, int parent, int first, int *num_trees,
                         struct candidate *list)
{
  for (int s = first; s < parent; s++)
    if (t->parent[s] == parent) list[(*num_trees)++] = (struct candidate){t->work[s], s};
  qsort(list, (size_t)*num_trees, sizeof *list, compare);
}

/* The work of the busiest thread, when each takes the largest tree that is left. */
static double busiest(int num_trees, const struct candidate *list)
{
  double most = 0.0, load[planned_threads] = {0.0};
  for (int k = 0; k < num_trees; k++) {
    int least = 0;
    for (int i = 1; i < planned_threads; i++)
      if (load[i] < load[least]) least = i;
    load[least] += list[k].work;
    if (load[least] > most) most = load[least];
  }
  return most;
}

/* The next tree to be taken apart: one that is no range of supernodes, else the largest. -1: there
 * is none. */
static int next_split(const struct tree *t, int num_trees, const struct candidate *list)
{
  for (int k = 0; k < num_trees; k++)
    if (!is_range(t, list[k].root)) return k;
  return num_trees > 0 && t->count[list[0].root] > 1 ? 0 : -1;
}

/* Takes trees apart as long as that makes the substitution faster: twice, for the second time up to
 * the best number of them. Returns the time over that of one thread; the trees that are left are in
 * the list, is_above marks what is above them. */
static double choose_trees(const struct keyway_supernodes *l, const struct tree *t,
                           int *num_trees, struct candidate *list, char *is_above)
{
  double total = t->work[t->num_supernodes], best = total;
  int best_splits = 0;
  for (int pass = 0; pass < 2; pass++) {
    double above = 0.0;
    *num_trees = 0;
    memset(is_above, 0, (size_t)t->num_supernodes);
    add_children(t, t->num_supernodes, 0, num_trees, list);
    for (int splits = 0; pass == 0 || splits < best_splits; splits++) {
      int k = next_split(t, *num_trees, list), s;
      if (pass == 0 && (k < 0 || is_range(t, list[k].root))) {
        double time = above + busiest(*num_trees, list);
        if (time < best) best_splits = splits;
        if (time < best) best = time;
      }
      /* No other trees can take less than all that is not above, shared by all threads. */
      if (k < 0 || (pass == 0 && above + (total - above) / planned_threads >= best)) break;
      s = list[k].root;
      list[k] = list[--*num_trees];
      add_children(t, s, t->first[s], num_trees, list);
      is_above[s] = 1;
      above += own_work(l, s);
    }
  }
  return total > 0.0 ? best / total : 1.0;
}

/* Room for the chosen trees. Returns 0 for success. */
static int make_room(const struct keyway_supernodes *l, const struct tree *t,
                     struct keyway_subtrees *trees)
{
  size_t threads = (size_t)trees->num_threads, n = (size_t)l->column[l->num_supernodes];
  trees->first = malloc((size_t)trees->num_trees * sizeof(int));
  trees->sum_start = malloc(((size_t)trees->num_trees + 1) * sizeof(long));
  if (!trees->first || !trees->sum_start) return -2;
  trees->sum_start[0] = 0;
  for (int k = 0; k < trees->num_trees; k++) {
    int s = trees->root[k];
    trees->first[k] = t->first[s];
    trees->sum_start[k + 1] = trees->sum_start[k] + length_of(l, s) - width_of(l, s);
  }
  trees->longest = 0;
  for (int s = 0; s < l->num_supernodes; s++)
    if (length_of(l, s) > trees->longest) trees->longest = length_of(l, s);
  trees->sum = malloc(((size_t)trees->sum_start[trees->num_trees] + 1) * sizeof(double));
  trees->place = malloc(threads * n * sizeof(int));
  trees->work = malloc(threads * (size_t)trees->longest * sizeof(double));
  return trees->sum && trees->place && trees->work ? 0 : -2;
}

void keyway_plan_subtrees(const struct keyway_supernodes *l, int num_threads,
                          struct keyway_subtrees *trees)
{
  struct tree t;
  size_t room = (size_t)l->num_supernodes + 1;
  struct candidate *list = malloc(room * sizeof *list);
  int status = make_tree(l, &t);
  memset(trees, 0, sizeof *trees);
  trees->num_threads = num_threads;
  trees->root = malloc(room * sizeof(int));
  trees->is_above = malloc(room);
  if (!list || !trees->root || !trees->is_above) status = -2;
  if (status == 0 && t.work[l->num_supernodes] >= worth_threads) {
    double share = choose_trees(l, &t, &trees->num_trees, list, trees->is_above);
    if (share > largest_share || trees->num_trees > most_trees) trees->num_trees = 0;
    for (int k = 0; k < trees->num_trees; k++) trees->root[k] = list[k].root;
    if (trees->num_trees > 0) status = make_room(l, &t, trees);
  }
  if (status != 0 || trees->num_trees == 0) keyway_free_subtrees(trees);
  free(list);
  free_tree(&t);
}

void keyway_free_subtrees(struct keyway_subtrees *trees)
{
  free(trees->root);
  free(trees->first);
  free(trees->sum_start);
  free(trees->sum);
  free(trees->is_above);
  free(trees->place);
  free(trees->work);
  memset(trees, 0, sizeof *trees);
}

/* Whether a part is worth waking threads up. */
static int is_worth_threads(const struct keyway_supernodes *l, enum keyway_part part,
                            const char *is_upper)
{
  double work = 0.0;
  for (int s = 0; s < l->num_supernodes && work < worth_threads; s++)
    if (keyway_is_in_part(s, part, is_upper)) work += own_work(l, s);
  return work >= worth_threads;
}

/* Whether a tree has supernodes of a part: the upper part holds all that is above a supernode. */
static int has_part(const struct keyway_subtrees *trees, int k, enum keyway_part part,
                    const char *is_upper)
{
  return part != KEYWAY_UPPER || is_upper[trees->root[k]];
}

/* Forward substitution in one tree. */
static void forward_in_tree(const struct keyway_supernodes *l, enum keyway_part part,
                            const char *is_upper, const struct keyway_subtrees *trees, int k,
                            double *y, double *work, int *place)
{
  int root = trees->root[k], end = l->column[root + 1], width = width_of(l, root);
  const int *above = l->row + l->row_start[root] + width;
  double *sum = trees->sum + trees->sum_start[k];
  for (int i = 0; i < length_of(l, root) - width; i++) {
    sum[i] = 0.0;
    place[above[i]] = i;
  }
  for (int s = trees->first[k]; s <= root; s++) {
    const int *row = l->row + l->row_start[s];
    int length = length_of(l, s), i = width_of(l, s);
    if (!keyway_is_in_part(s, part, is_upper)) continue;
    keyway_forward_one(l, s, y, work);
    for (; i < length && row[i] < end; i++) y[row[i]] += work[i];
    for (; i < length; i++) sum[place[row[i]]] += work[i];
  }
}

void keyway_forward_in_trees(const struct keyway_supernodes *l, enum keyway_part part,
                             const char *is_upper, const struct keyway_subtrees *trees, double *y)
{
  size_t n = (size_t)l->column[l->num_supernodes], longest = (size_t)trees->longest;
#pragma omp parallel num_threads(trees->num_threads) if (is_worth_threads(l, part, is_upper))
  {
    size_t own = (size_t)omp_get_thread_num();
#pragma omp for schedule(dynamic)
    for (int k = 0; k < trees->num_trees; k++)
      if (has_part(trees, k, part, is_upper))
        forward_in_tree(l, part, is_upper, trees, k, y, trees->work + own * longest,
                        trees->place + own * n);
  }
  for (int k = 0; k < trees->num_trees; k++) {
    int root = trees->root[k], width = width_of(l, root);
    const int *above = l->row + l->row_start[root] + width;
    const double *sum = trees->sum + trees->sum_start[k];
    if (!has_part(trees, k, part, is_upper)) continue;
    for (int i = 0; i < length_of(l, root) - width; i++) y[above[i]] += sum[i];
  }
  for (int s = 0; s < l->num_supernodes; s++)
    if (trees->is_above[s] && keyway_is_in_part(s, part, is_upper))
      keyway_forward_and_add(l, s, y, trees->work);
}

void keyway_backward_in_trees(const struct keyway_supernodes *l, enum keyway_part part,
                              const char *is_upper, const struct keyway_subtrees *trees, double *y)
{
  size_t longest = (size_t)trees->longest;
  for (int s = l->num_supernodes - 1; s >= 0; s--)
    if (trees->is_above[s] && keyway_is_in_part(s, part, is_upper))
      keyway_backward_one(l, s, y, trees->work);
#pragma omp parallel for schedule(dynamic) num_threads(trees->num_threads) \
  if (is_worth_threads(l, part, is_upper))
  for (int k = 0; k < trees->num_trees; k++) {
    double *work = trees->work + (size_t)omp_get_thread_num() * longest;
    if (!has_part(trees, k, part, is_upper)) continue;
    for (int s = trees->root[k]; s >= trees->first[k]; s--)
      if (keyway_is_in_part(s, part, is_upper)) keyway_backward_one(l, s, y, work);
  }
}
