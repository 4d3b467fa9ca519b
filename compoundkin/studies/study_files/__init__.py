"""Studies as files: TOML or JSON, angles in degrees; their keys, their reader, their writer, their schema."""
