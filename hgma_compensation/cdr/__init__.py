"""Serialised messages read and patched in place, many at a time, without message objects.

Only what DDS and bags hold in practice is recognised: plain little-endian CDR of exactly the right size. Anything else
is left to the ordinary path (``hgma_compensation.messages``), which the results here equal bit for bit.
"""
