set(sources
  keyword_spec.f90
  deck_card.f90
  deck_card_impl.f90
)
