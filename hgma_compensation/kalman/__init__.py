"""The Kalman stage after the drift model."""
