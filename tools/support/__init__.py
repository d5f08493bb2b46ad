"""Support functions as objects: evaluated, combined."""
