"""Meshes of other programs (Gmsh, Abaqus, VTK, MED, ...) as decks of Keyway."""
