"""Display: in, rows; out, HTML for notebooks, and data frames of other libraries."""
