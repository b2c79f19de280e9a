set(sources
  damage_constants.f90
  crack_band.f90
  material_points.f90
  material_law.f90
  material_elastic.f90
  material_catalogue.f90
)
