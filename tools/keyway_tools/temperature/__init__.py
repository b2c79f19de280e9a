"""The seasonal temperature of a dam from air and water (docs/temperature.md)."""
