"""Long runs that look for what no single test shows."""
