set(sources
  element_formulation.f90
  joint_points.f90
)
