"""`python -m oodscen` is the command line."""

from oodscen.cli import main

main(prog_name="oodscen")
