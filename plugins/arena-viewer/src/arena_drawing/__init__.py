"""The 2-D painter of the arena suite; it offers no component."""
