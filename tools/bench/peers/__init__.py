"""The same dam in Keyway, CalculiX and OpenSees."""
