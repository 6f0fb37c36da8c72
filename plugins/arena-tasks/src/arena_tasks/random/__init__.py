"""Problems that are drawn, and curricula of them."""
