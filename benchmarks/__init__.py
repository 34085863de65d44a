"""Tables and timings, each printed by a make target; nothing here is installed."""
