"""The one path from raw to compensated acceleration, used by node, offline tools and training."""
