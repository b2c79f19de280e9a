set(sources
  block_motion.f90
  free_blocks.f90
  held_together.f90
  joint_capacity.f90
  rigid_blocks.f90
)
