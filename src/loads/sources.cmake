set(sources
  applied_load.f90
)
