"""Synthetic datasets with exact truth, rendered in MuJoCo."""
