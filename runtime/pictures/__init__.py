"""Pictures by Matplotlib."""
