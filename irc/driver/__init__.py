"""The driver: in, a `Task`; out, a program, or a validated schedule with its proven status."""
