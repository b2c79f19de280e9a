"""The commands keyway-plot, keyway-batch and keyway-compare."""
