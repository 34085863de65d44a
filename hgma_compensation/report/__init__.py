"""Reports for people: what a diagnosis found, as one page that needs nothing but itself."""
