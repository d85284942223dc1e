"""OpenSCENARIO XML files as scenes."""
