"""From the outside to a `Task`: JSON text and importers of other people's formats."""
