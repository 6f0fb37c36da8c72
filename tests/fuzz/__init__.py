"""Every reader of the suite against files that no one would write on purpose (docs/limits.md)."""
