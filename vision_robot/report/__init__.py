"""Pages a person would put into a lab book: self-contained HTML with figures as SVG."""
