"""What a recording can and cannot tell of a sensor, judged before anything is fitted to it. Offline only."""
