"""The leaderboard: rates, intervals, comparisons and sentences."""
