"""The parts of closed-loop red teaming.

`rounds` defines the lines of the log, `near_duplicates` measures the similarity of a proposal to what exists,
`excerpt` chooses the part of a tree that a prompt shows, `changes` turns a decision into edits, `stopping`
has the stopping rules, and `saturation` estimates how much is left to find. Importing the package loads none
of them.
"""
