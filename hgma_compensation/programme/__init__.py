"""Which oven programme sets off the effects that are looked for. Pure functions; nothing is recorded here."""
