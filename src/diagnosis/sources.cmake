set(sources
  block_motion.f90
  free_blocks.f90
  joint_capacity.f90
  rigid_blocks.f90
  tie_resistance.f90
)
