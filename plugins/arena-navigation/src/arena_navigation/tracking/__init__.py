"""Moving obstacles from scans."""
