"""The calibration: what training hands to the node, and the file it travels in."""
