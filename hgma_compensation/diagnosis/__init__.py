"""From the residual to the effect that a calibration lacks. Offline only."""
