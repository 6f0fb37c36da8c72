"""One episode as a job: what is built for it, with which code, and the row that it leaves."""
