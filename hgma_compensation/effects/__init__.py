"""Physical effects that a map of the present temperature cannot carry: one file for each of them."""
