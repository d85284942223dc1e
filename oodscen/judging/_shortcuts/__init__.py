"""Shortcuts: telling rare from ordinary without understanding anything."""
