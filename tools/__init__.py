"""Scripts that generate the shipped data; nothing here runs with the product."""
