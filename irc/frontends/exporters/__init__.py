"""Exporters: in, a `Task`; out, the text of another format, or what the format cannot say."""
