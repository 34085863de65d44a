"""Calibration documents made wrong in every way that is known, and a judge that shares no code with the parser."""
