"""Entry point of `python -m oodscen`, the command line."""

from oodscen._cli import main

main(prog_name="oodscen")
