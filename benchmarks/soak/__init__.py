"""Bounded runs under load that end with a verdict; each prints its figures as one line of JSON."""
