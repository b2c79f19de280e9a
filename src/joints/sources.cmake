set(sources
  joint_law.f90
)
