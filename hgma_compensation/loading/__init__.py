"""Reading, validating and preparing a calibration in another process, while the caller goes on with its stream."""
