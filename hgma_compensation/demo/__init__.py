"""``make demo``: the whole job on a recording, with the real node as a process."""
