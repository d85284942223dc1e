"""What closed-loop red teaming is made of.

`rounds` has the lines of its log, `novelty` tells how near a proposal is to what exists, `excerpt`
chooses what of a tree is shown, `changes` turns a decision into edits, `stopping` says when to stop, and
`saturation` estimates how much is left to be found. Importing the package loads none of them.
"""
