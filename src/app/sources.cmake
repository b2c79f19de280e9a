set(sources
  cli.f90
  model_summary.f90
  check_deck.f90
  run_analysis.f90
  run_material.f90
  main.f90
)
