set(sources
  material_law.f90
)
