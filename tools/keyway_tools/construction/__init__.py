"""Dams that are built lift by lift, grouted, cooled and warmed (docs/theory.md, 15)."""
