/* For functions that are compiled for several processors: the best is chosen when the program
 * starts. */
#ifndef EACH_PROCESSOR_H
#define EACH_PROCESSOR_H

#if defined(__x86_64__) && defined(__gnu_linux__) && !defined(__clang__)
#define FOR_EACH_PROCESSOR __attribute__((target_clones("avx512f", "fma", "default")))
#else
#define FOR_EACH_PROCESSOR
#endif

#endif
