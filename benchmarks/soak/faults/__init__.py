"""A long stream with every fault that a robot knows, through the real node: ``python -m benchmarks.soak.faults``."""
