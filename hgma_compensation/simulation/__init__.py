"""An oven test of a simulated high-g accelerometer. Offline only."""
