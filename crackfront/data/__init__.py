"""Files and what stands in them: records, netCDF, YAML, units in texts, provenance."""
