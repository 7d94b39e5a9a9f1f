"""Where cameras are: over a table, beside each other; and where a tool is."""
