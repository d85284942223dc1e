"""Makers of shipped data: nothing here runs with the product."""
