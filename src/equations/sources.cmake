set(sources
  anderson_mixing.f90
  cholmod_bridge.c
  column_products.f90
  distributed/petsc_equations.f90
  distributed/unknown_layout.f90
  distributed/unknown_parts.f90
  elimination/cholmod_calls.f90
  elimination/cholmod_status.f90
  elimination/factor_top.f90
  elimination/group_dissection.f90
  elimination/metis_bridge.c
  elimination/wider_pattern.f90
  entry_lists.f90
  global_vectors.f90
  linear_solver.f90
  low_rank/solver_low_rank.f90
  matrix_parts.f90
  matrix_pattern.f90
  nested_dissection.f90
  solver_catalogue.f90
  solver_cholmod.f90
  solver_petsc.f90
  solver_umfpack.f90
  spectrum/arpack.f90
  spectrum/matrix_condition.f90
  supernodes/active_solve.f90
  supernodes/factor_top.c
  supernodes/fused_columns.c
  supernodes/last_solution.f90
  supernodes/refined_solve.f90
  supernodes/selected_inverse.c
  supernodes/single_factor.c
  supernodes/subtrees.c
  supernodes/supernodal_solve.c
)
# What stands behind petsc_equations.f90 and arpack.f90
if(KEYWAY_PETSC)
  list(APPEND sources distributed/block_list.c distributed/block_matrix.c
       distributed/iteration/coarse_space.c distributed/iteration/incomplete_factor.c
       distributed/iteration/last_solutions.c distributed/iteration/node_groups.c
       distributed/iteration/two_levels.c distributed/matrix_patch.c distributed/mumps_factor.c
       distributed/petsc_bridge.c distributed/petsc_start.c spectrum/parallel_arpack.c)
else()
  list(APPEND sources distributed/without_petsc.c spectrum/serial_arpack.c)
endif()
