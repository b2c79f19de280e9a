set(sources
  kinds.f90
  diagnostics.f90
  parse_text.f90
  errors.f90
)
