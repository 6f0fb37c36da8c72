"""The routes below /api, a module for each page of the studio."""
