set(sources
  linear_solver.f90
)
