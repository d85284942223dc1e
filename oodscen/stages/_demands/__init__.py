"""Ordinary demands: everyday traffic that asks the ego for a reaction, one beside every rare scene."""
