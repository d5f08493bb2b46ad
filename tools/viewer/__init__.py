"""Pages for browsers: samples and their normals, where a click on a sample marks its normal."""
