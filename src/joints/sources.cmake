set(sources
  joint_law.f90
  slip_dissipation.f90
  joint_constants.f90
  joint_contraction.f90
  joint_catalogue.f90
)
