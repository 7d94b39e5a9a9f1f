"""Closing the loop: laws that bring a hand to where a camera sees it coincide with a thing."""
