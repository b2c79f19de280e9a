set(sources
  guest_type.f90
  scatter_matrix.f90
)
