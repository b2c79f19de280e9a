set(sources
  guest_type.f90
  history/guest_history.f90
  scatter_matrix.f90
)
