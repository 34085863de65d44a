"""The pictures of the documents, and the tables in them that are written from the code: ``make pictures``."""
