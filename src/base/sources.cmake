set(sources
  kinds.f90
  errors.f90
)
