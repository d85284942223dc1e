"""Scenes as OpenSCENARIO XML files with their OpenDRIVE maps."""
