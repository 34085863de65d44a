"""Calibration of many sensors: one job for each, somewhere to run them, and what became of them all."""
