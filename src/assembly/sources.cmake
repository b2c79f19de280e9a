set(sources
  problem_definition.f90
  analysis_state.f90
  increment_listener.f90
  matrix_pattern.f90
)
