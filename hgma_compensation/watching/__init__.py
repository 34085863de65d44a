"""What ``hgma watch`` shows of a running node."""
