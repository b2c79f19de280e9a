set(sources
  dam_mesh.f90
  mesh_sets.f90
  mesh_faces.f90
  amplitudes.f90
  step_plan.f90
)
