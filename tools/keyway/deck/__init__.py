"""Decks that are read, changed and written; what is not changed stays byte for byte."""

from .card import Card
from .deck import Deck, DeckError

__all__ = ["Card", "Deck", "DeckError"]
