"""What the report shows: figures, pictures, the page, and ``arena report``."""
