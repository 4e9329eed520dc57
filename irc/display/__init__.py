"""Tables in, and what shows them out: HTML for notebooks, and data frames of other libraries."""
