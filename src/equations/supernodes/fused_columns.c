/* The time of a substitution is that of reading the factor from memory: four columns are used at
 * once, so that t stays in registers and in the nearest cache. Blocks are short, and processors of
 * Intel are slow to see that they follow one another in memory: the values that are needed next are
 * asked for in good time. Those of AMD see it, and take up to 1.5 times as long with such requests in
 * double precision; blocks in single precision are half as long, and take 0.7 to 0.9 of the time
 * (docs/performance.md, "Substitution"). */
#include "fused_columns.h"
#include "../../base/math/each_processor.h"
#include <stddef.h>

enum {
  rows_at_once = 32,
  line = 64,  /* [bytes] of the cache */
  level_2 = 2 /* the cache that takes what is asked for; the first is too small */
};

static int asks_ahead(size_t size_of_value)
{
  if (size_of_value < sizeof(double)) return 1;
#if defined(__x86_64__) && defined(__GNUC__)
  return __builtin_cpu_is("intel") != 0;
#else
  return 0;
#endif
}

#define VALUE double
#define OF_PRECISION(name) name##_double
#include "fused_columns_template.h"
#undef VALUE
#undef OF_PRECISION

#define VALUE float
#define OF_PRECISION(name) name##_single
#include "fused_columns_template.h"
