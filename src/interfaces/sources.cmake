set(sources
  surface_segments.f90
  surface_coupling.f90
)
