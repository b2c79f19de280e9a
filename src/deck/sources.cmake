set(sources
  keyword_spec.f90
)
