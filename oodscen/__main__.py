"""`python -m oodscen` is the command line."""

from oodscen._cli import main

main(prog_name="oodscen")
