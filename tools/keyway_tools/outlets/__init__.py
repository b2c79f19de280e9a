"""Outlets through the upper part of an arch dam: holes, piers, corbel."""
