"""The DSL (`.irc` files): text → plain document with places, and task → text."""
