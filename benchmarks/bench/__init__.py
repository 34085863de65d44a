"""Speed and memory, each figure a ratio to a rival that runs in the same minutes: ``make bench``."""
