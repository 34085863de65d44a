"""To and from autopilots: cubic coefficients for PX4 and ArduPilot, and what it costs; tables of their logs."""
