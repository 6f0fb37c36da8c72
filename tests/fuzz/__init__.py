"""Every reader of the suite against files that nobody would write on purpose (docs/limits.md)."""
