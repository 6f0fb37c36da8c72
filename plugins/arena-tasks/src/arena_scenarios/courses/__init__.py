"""The pack ``iso18646``: courses that measure navigation as ISO 18646-2 names it."""
