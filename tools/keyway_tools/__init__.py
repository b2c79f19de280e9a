"""Meshes, ground motions and pictures for Keyway decks and results."""
