"""`sample` and `sample_stream`: from a surface and a request to samples."""
