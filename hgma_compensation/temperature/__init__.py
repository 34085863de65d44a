"""Temperature features, causal and the same bit for bit in a batch and sample by sample."""
