"""The leaderboard: rates, intervals, comparisons and findings."""
