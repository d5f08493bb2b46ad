"""Data sets of many parts: several processes make them; `Dataset` reads them."""
