"""Error before and after. Offline only."""
