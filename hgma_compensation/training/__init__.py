"""From recordings to a calibration. Offline only."""
