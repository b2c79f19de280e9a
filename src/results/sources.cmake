set(sources
  text_buffers.f90
  json_writer.f90
  sha256.f90
  file_system.f90
  principal_stress.f90
  vtk_order.f90
)
