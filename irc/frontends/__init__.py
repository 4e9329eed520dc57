"""Front ends: in, a text in JSON, the DSL, English or another format; out, a `Task`."""
