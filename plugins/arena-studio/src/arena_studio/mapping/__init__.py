"""The map editor's files: images cell by cell, YAML text, drawn worlds, furniture."""
