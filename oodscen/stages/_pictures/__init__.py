"""Pictures of drives: views from above, videos, and measures of what a frame shows."""
