"""What people do, who they are, when they come and go: the state machine and what it needs."""
