"""What Sphinx needs to learn for this manual: our docstrings, pages made from the program, formulas."""
