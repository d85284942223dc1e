"""Judging models and drivers: answers, references, safe sets, statistics and the leaderboard."""
