"""Support functions as objects: evaluation and operations."""
