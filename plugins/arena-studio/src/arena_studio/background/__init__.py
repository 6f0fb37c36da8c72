"""What is done in processes beside the server, and the requests by which it is asked for."""
