"""What a sensor has had of shocks, after one more sample."""

from dataclasses import dataclass


@dataclass
class Sums:
    """Sums over shocks (permanent, decaying), the present shock (peak, what is left of it) and the level about it."""

    permanent: float
    decaying: float
    peak: float
    remainder: float
    quiet: float
    above: float
    level: float

    def pass_time(self, seconds: float, decay: float, merge: float) -> None:
        """Let the sums decay; forget the present shock once it is over."""
        self.decaying *= decay
        self.remainder *= decay
        self.above = self.above + seconds if self.quiet == 0.0 else 0.0
        self.quiet += seconds
        if self.quiet > merge:
            self.peak = self.remainder = 0.0

    def set_peak(self, peak: float) -> None:
        """Let the present shock count with this peak."""
        self.permanent += peak - self.peak
        self.decaying += peak - self.remainder
        self.peak = self.remainder = peak
