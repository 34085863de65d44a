"""Drift models: temperature features in, drift of one channel out."""
