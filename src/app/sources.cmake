set(sources
  main.f90
)
