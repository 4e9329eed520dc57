"""Tables: in, sheets of a spreadsheet or CSV files; out, a `Task`, and the way back."""
