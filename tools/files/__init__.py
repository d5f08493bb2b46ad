"""Files of samples and meshes; `formats` lists the formats."""
