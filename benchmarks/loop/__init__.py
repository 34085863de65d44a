"""Benchmark of the loop residual → effect → augmented calibration on simulated sensors whose effects nobody is told."""
