"""What the report says in numbers and sentences."""
