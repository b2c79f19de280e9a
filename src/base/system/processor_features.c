/* What the processor offers beyond the least one of its kind. */

/* 1 where registers of four double-precision numbers can be used (AVX2). */
int keyway_has_wide_registers(void) {
#if defined(__x86_64__) && defined(__GNUC__)
  return __builtin_cpu_supports("avx2") != 0;
#else
  return 0;
#endif
}
