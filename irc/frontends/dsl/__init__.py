"""The DSL (`.irc` files): in, text; out, the plain document with places; and a task as text."""
