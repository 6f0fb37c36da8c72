"""Problems from files of all formats."""
