set(sources
  keyword_spec.f90
  card_lines.f90
  deck_card.f90
  card_check.f90
)
