"""JSON: in, text; out, the raw document, with every fault of the text at its place."""
